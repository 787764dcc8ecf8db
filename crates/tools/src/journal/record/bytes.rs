//! What records of a journal are made of: numbers, bricks and grids as bytes, and read again.

use glam::{DAffine3, DVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensity_brick::IntensityBrick;

use super::Wrong;
use crate::journal::entry::Action;

/// Voxels of a segment with a grid of its own, at most: no file can ask for more memory.
const MOST_OWN_VOXELS: u64 = 1 << 33;

pub(super) fn words_as_bytes(words: &[u64; 8]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

pub(super) fn values_as_bytes(values: &[i16; 512]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

pub(super) fn push_count(bytes: &mut Vec<u8>, count: usize) {
    // bricks of a scan are fewer than its voxels, and those fit
    bytes.extend((count as u32).to_le_bytes());
}

pub(super) fn push_numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

pub(super) fn push_affine(bytes: &mut Vec<u8>, affine: &DAffine3) {
    push_numbers(bytes, &affine.to_cols_array());
}

pub(super) fn push_bits(bytes: &mut Vec<u8>, index: u32, bits: &BitBrick) {
    bytes.extend(index.to_le_bytes());
    bytes.extend(words_as_bytes(&bits.0));
}

pub(super) fn number_of(action: Action) -> u8 {
    match action {
        Action::Do => 0,
        Action::Undo => 1,
        Action::Redo => 2,
        Action::Start => 3,
    }
}

/// What is left to read.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl Reader<'_> {
    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], Wrong> {
        let (taken, left) = self.0.split_first_chunk().ok_or("it ends too early")?;
        self.0 = left;
        Ok(*taken)
    }

    pub(super) fn byte(&mut self) -> Result<u8, Wrong> {
        Ok(self.take::<1>()?[0])
    }

    pub(super) fn number(&mut self) -> Result<u32, Wrong> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn count(&mut self) -> Result<usize, Wrong> {
        Ok(self.number()? as usize)
    }

    pub(super) fn action(&mut self) -> Result<Action, Wrong> {
        match self.byte()? {
            0 => Ok(Action::Do),
            1 => Ok(Action::Undo),
            2 => Ok(Action::Redo),
            3 => Ok(Action::Start),
            _ => Err("neither there, done, undone nor redone"),
        }
    }

    pub(super) fn segment(&mut self) -> Result<SegmentId, Wrong> {
        match self.byte()? {
            0 => Err("segment 0, which stands for none"),
            id => Ok(SegmentId(id)),
        }
    }

    pub(super) fn flag(&mut self) -> Result<bool, Wrong> {
        match self.byte()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err("neither yes nor no"),
        }
    }

    pub(super) fn float(&mut self) -> Result<f64, Wrong> {
        let number = f64::from_le_bytes(self.take()?);
        number.is_finite().then_some(number).ok_or("no number")
    }

    /// A number that may be without end.
    pub(super) fn limit(&mut self) -> Result<f64, Wrong> {
        let number = f64::from_le_bytes(self.take()?);
        (!number.is_nan()).then_some(number).ok_or("no number")
    }

    pub(super) fn affine(&mut self) -> Result<DAffine3, Wrong> {
        let mut columns = [0.0; 12];
        for number in &mut columns {
            *number = self.float()?;
        }
        Ok(DAffine3::from_cols_array(&columns))
    }

    pub(super) fn grid(&mut self) -> Result<Grid, Wrong> {
        let dimensions = UVec3::new(self.number()?, self.number()?, self.number()?);
        if u64::from(dimensions.x) * u64::from(dimensions.y) > MOST_OWN_VOXELS
            || dimensions.as_u64vec3().element_product() > MOST_OWN_VOXELS
        {
            return Err("more voxels than a segment of its own may have");
        }
        let spacing = DVec3::new(self.float()?, self.float()?, self.float()?);
        let patient_from_grid = self.affine()?;
        Grid::from_affine(dimensions, spacing, patient_from_grid).map_err(|_| "a grid that is none")
    }

    pub(super) fn bits(&mut self) -> Result<(u32, BitBrick), Wrong> {
        let index = self.number()?;
        let mut brick = BitBrick::EMPTY;
        for word in &mut brick.0 {
            *word = u64::from_le_bytes(self.take()?);
        }
        Ok((index, brick))
    }

    pub(super) fn values(&mut self) -> Result<IntensityBrick, Wrong> {
        let mut brick = IntensityBrick::ZERO;
        for value in &mut brick.0 {
            *value = i16::from_le_bytes(self.take()?);
        }
        Ok(brick)
    }

    pub(super) fn end(&self) -> Result<(), Wrong> {
        self.0
            .is_empty()
            .then_some(())
            .ok_or("more bytes than it needs")
    }
}
