//! The time of single calls and of many.

use std::time::Instant;

use std::hint::black_box;

/// How long calls take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Calls timed.
    pub count: usize,
    /// Calls per second, timed all together.
    pub per_second: f64,
    /// Half of the calls take at most this long [ns], the reading of the clock taken off.
    pub median_ns: f64,
    /// 99 of 100 calls.
    pub p99_ns: f64,
    /// 999 of 1000 calls.
    pub p999_ns: f64,
    /// All calls.
    pub max_ns: f64,
}

impl Timing {
    /// Times calls 0 to `count` in this order, first all together, then one by one; `prepare`
    /// makes the function afresh for each pass.
    pub fn of<F: FnMut(usize) -> bool>(count: usize, mut prepare: impl FnMut() -> F) -> Self {
        // a pass to warm up, then one between two readings of the clock
        pass(count, prepare());
        let call = prepare();
        let start = Instant::now();
        pass(count, call);
        let all = start.elapsed().as_secs_f64();

        let mut call = prepare();
        let clock_ns = reading_of_the_clock();
        let times = (0..count)
            .map(|number| {
                let start = Instant::now();
                black_box(call(number));
                (start.elapsed().as_nanos() as f64 - clock_ns).max(0.0)
            })
            .collect();
        Self {
            per_second: count as f64 / all.max(1e-9),
            ..Self::of_times(times)
        }
    }

    /// Of single calls [ns] alone; how many a second is what their mean tells.
    pub fn of_times(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let at = |share: f64| quantile(&times, share);
        let count = times.len();
        let all_ns = times.iter().sum::<f64>();
        Self {
            count,
            per_second: 1e9 * count as f64 / all_ns.max(1.0),
            median_ns: at(0.5),
            p99_ns: at(0.99),
            p999_ns: at(0.999),
            max_ns: at(1.0),
        }
    }
}

fn pass(count: usize, mut call: impl FnMut(usize) -> bool) {
    for number in 0..count {
        black_box(call(number));
    }
}

/// What two readings of the clock take, typically [ns].
fn reading_of_the_clock() -> f64 {
    let mut times: Vec<f64> = (0..1001)
        .map(|_| Instant::now().elapsed().as_nanos() as f64)
        .collect();
    times.sort_by(f64::total_cmp);
    quantile(&times, 0.5)
}

/// The smallest value that is not below this fraction of sorted ones; 0 where there are none.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occur() {
        let sorted: Vec<f64> = (1..=1000).map(f64::from).collect();
        let fractions = [0.5, 0.99, 0.999, 1.0];
        let quantiles = fractions.map(|share| quantile(&sorted, share));
        assert_eq!(quantiles, [500.0, 990.0, 999.0, 1000.0]);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn every_pass_begins_afresh_and_calls_in_order() {
        let mut passes = Vec::new();
        let timing = Timing::of(100, || {
            let pass = std::rc::Rc::new(std::cell::RefCell::new(Vec::new()));
            passes.push(std::rc::Rc::clone(&pass));
            move |call| {
                pass.borrow_mut().push(call);
                true
            }
        });
        assert_eq!((timing.count, passes.len()), (100, 3));
        assert!(
            passes
                .iter()
                .all(|pass| pass.borrow().iter().copied().eq(0..100))
        );
        assert!(timing.median_ns <= timing.p99_ns && timing.p999_ns <= timing.max_ns);
    }
}
