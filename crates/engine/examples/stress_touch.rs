//! Runs `palpate bench stress` without Python, on no bone: runs from and to, model.
#![expect(clippy::print_stdout, reason = "figures are what this example is for")]

use palpate_engine::bench::Model;
use palpate_engine::bench::stress::run;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |place: usize, default: u64| {
        arguments
            .get(place)
            .and_then(|given| given.parse().ok())
            .unwrap_or(default)
    };
    let model = arguments.get(3).map_or("exact", String::as_str);
    let model = Model::named(model).unwrap_or_default();
    for run_number in number(1, 0)..number(2, 40) {
        let start = std::time::Instant::now();
        let report = run(1, run_number, model, None);
        let per_move = start.elapsed().as_nanos() as f64 / report.moves.max(1) as f64;
        println!("{run_number:4} {per_move:8.0} ns/move {report:?}");
    }
}
