//! Prints what `palpate bench touch-quality` measures, without Python; a second or two:
//!
//!     cargo run --release -p palpate-bench --example touch_quality \
//!         [part of a case's name] [part of the name of a way of touch]
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

use palpate_bench::quality::{Touch, cases_where, measure};

fn main() {
    let part = |number| std::env::args().nth(number).unwrap_or_default();
    let [wanted, wanted_touch] = [1, 2].map(part);
    let touches = Touch::ALL.into_iter();
    for touch in touches.filter(|touch| touch.name().contains(&wanted_touch)) {
        let cases = cases_where(touch.radius(), |name| name.contains(&wanted));
        println!(
            "{:46}  dir°mean   95%  mag%  ripple lag95   max prox95  max jitter pops solid% stuck  step touch%",
            touch.name()
        );
        for case in &cases {
            let f = measure(case, touch);
            println!(
                "{:48} {:6.2} {:6.2} {:5.1} {:6.3} {:5.2} {:5.2} {:5.2} {:5.2} {:6.3} {:4.0} {:5.1} {:5.0} {:6.3} {:5.1}",
                case.name,
                f.direction_mean,
                f.direction_95,
                100.0 * f.magnitude_rmse,
                f.ripple,
                f.force_lag_95,
                f.force_lag_max,
                f.proxy_lag_95,
                f.proxy_lag_max,
                f.jitter,
                f.pop_throughs,
                100.0 * f.solid_fraction,
                f.stuck,
                f.force_step,
                100.0 * f.contact_fraction,
            );
        }
    }
}
