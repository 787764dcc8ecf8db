//! How long a test goes on whose worth grows with what it tries: every crate's tests include this.
//!
//! Short in `make test`; long where `PALPATE_LONG` is 1, in `make test-long`.

/// Returns one of two lengths.
pub fn by_length<T>(short: T, long: T) -> T {
    if std::env::var("PALPATE_LONG").is_ok_and(|asked| asked == "1") {
        long
    } else {
        short
    }
}
