//! One body as the probe meets it: its voxels, and for a ball the cells that its centre cannot be in.
//!
//! Frame: the body's own grid. Nothing here allocates after it was made, so that the servo can
//! exchange bricks; what is remembered of a ball's cells follows each exchange.

use glam::{DVec3, IVec3};
use palpate_haptics::ball::{Ball, BallError, BallShape};
use palpate_haptics::ball_limits::ball_limits;
use palpate_haptics::exact::ExactLimits;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy::Occupancy;

use crate::known_shares::KnownShares;
use crate::patched::Patched;

/// Voxels that are touched with a point or a ball.
#[derive(Debug)]
pub struct Body {
    bits: Bits,
    ball: Option<Box<Balls>>,
    /// What more is known of its surface than its bits.
    shares: Option<KnownShares>,
}

/// A ball with what it knows of these voxels.
#[derive(Debug)]
struct Balls {
    /// Where its centre cannot be.
    hard: Ball,
    /// The same without the safe side: what the smooth force is made of.
    soft: Ball,
    /// For changes that are only tried.
    trial: Ball,
}

impl Body {
    /// These voxels, for a probe of a radius [mm]; 0 is a point.
    ///
    /// # Errors
    /// Where the ball is too large for these voxels.
    pub fn new(bits: Bits, radius: f64, spacing: DVec3) -> Result<Self, BallError> {
        let ball = if radius > 0.0 {
            let hard = BallShape::new(radius, spacing)?;
            Some(Box::new(Balls {
                hard: Ball::new(hard),
                soft: Ball::new(BallShape::soft(radius, spacing)?),
                trial: Ball::new(hard),
            }))
        } else {
            None
        };
        Ok(Self {
            bits,
            ball,
            shares: None,
        })
    }

    /// The same with what is known of the shares of its voxels, which is of use to a point only:
    /// a ball's surface is another.
    #[must_use]
    pub fn knowing(mut self, shares: Option<KnownShares>) -> Self {
        self.shares = shares.filter(|_| self.ball.is_none());
        self
    }

    /// The voxels.
    #[must_use]
    pub fn bits(&self) -> &Bits {
        &self.bits
    }

    /// How far the probe reaches [voxels]; 0 for a point.
    #[must_use]
    pub fn reach(&self) -> IVec3 {
        self.ball
            .as_ref()
            .map_or(IVec3::ZERO, |ball| ball.hard.shape().reach())
    }

    /// How much work a tick of `exact` may do with this probe.
    #[must_use]
    pub fn limits(&self) -> ExactLimits {
        match &self.ball {
            None => ExactLimits::default(),
            Some(ball) => ball_limits(ball.hard.shape()),
        }
    }

    /// Exchanges one brick.
    pub fn swap(&mut self, swap: &mut BrickSwap<BitBrick>) {
        if let Some(ball) = &mut self.ball {
            let changed = self.bits.bricks().box_of(swap.index);
            ball.hard.invalidate_box(&changed);
            ball.soft.invalidate_box(&changed);
        }
        self.bits.swap(swap);
    }

    /// Exchanges one brick of a segment that it is made of, after which shares are told.
    pub fn swap_part(&mut self, id: SegmentId, swap: &mut BrickSwap<BitBrick>) {
        if let Some(shares) = &mut self.shares {
            shares.swap_part(id, swap);
        }
    }

    /// The body as it would be with some bricks exchanged, by rising index.
    pub fn with<'a>(&'a mut self, swaps: &'a [BrickSwap<BitBrick>]) -> (&'a Self, View<'a>) {
        if let Some(ball) = &mut self.ball {
            ball.trial.invalidate();
        }
        let body = &*self;
        let view = View {
            patched: Patched::new(&body.bits, swaps),
            ball: body.ball.as_ref().map(|ball| &ball.trial),
        };
        (body, view)
    }

    /// The body as it is, like those with exchanged bricks.
    #[must_use]
    pub fn view(&self) -> View<'_> {
        View {
            patched: Patched::new(&self.bits, &[]),
            ball: self.ball.as_ref().map(|ball| &ball.hard),
        }
    }

    /// The solid voxel that the probe rests against where a voxel holds it back.
    #[must_use]
    pub fn solid_near(&self, voxel: IVec3) -> Option<IVec3> {
        match &self.ball {
            None => self.bits.is_solid(voxel).then_some(voxel),
            Some(ball) => ball.hard.solid_near(&self.bits, voxel),
        }
    }
}

impl Occupancy for Body {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        match &self.ball {
            None => self.bits.is_solid(voxel),
            Some(ball) => ball.is_blocked(&self.bits, voxel),
        }
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        match &self.ball {
            None => self.bits.block(min),
            Some(ball) => ball.block(&self.bits, min),
        }
    }

    #[inline]
    fn smooth_block(&self, min: IVec3) -> BitBrick {
        match &self.ball {
            None => self.bits.block(min),
            Some(ball) => ball.smooth_block(&self.bits, min),
        }
    }

    #[inline]
    fn knows_shares(&self) -> bool {
        self.shares.is_some()
    }

    #[inline]
    fn share(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        self.shares.as_ref()?.share(voxel, solid)
    }
}

/// Not put into the loops that ask: those of a point stay short.
impl Balls {
    #[inline(never)]
    fn is_blocked(&self, bits: &Bits, voxel: IVec3) -> bool {
        self.hard.dilate(bits).is_solid(voxel)
    }

    #[inline(never)]
    fn block(&self, bits: &Bits, min: IVec3) -> BitBrick {
        self.hard.dilate(bits).block(min)
    }

    #[inline(never)]
    fn smooth_block(&self, bits: &Bits, min: IVec3) -> BitBrick {
        self.soft.dilate(bits).block(min)
    }
}

/// A body, perhaps with some bricks exchanged.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    patched: Patched<'a>,
    ball: Option<&'a Ball>,
}

impl Occupancy for View<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        match self.ball {
            None => self.patched.is_solid(voxel),
            Some(ball) => ball.dilate(&self.patched).is_solid(voxel),
        }
    }

    fn block(&self, min: IVec3) -> BitBrick {
        match self.ball {
            None => self.patched.block(min),
            Some(ball) => ball.dilate(&self.patched).block(min),
        }
    }
}
