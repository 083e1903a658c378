//! Time that the calling thread has spent on a processor: what work costs, however busy the machine is.

use std::time::Duration;

/// Since some moment of this thread's own; only differences mean something.
#[cfg(unix)]
pub fn spent() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Wall time, where the system's thread clock is out of reach: never less than the thread's own.
#[cfg(not(unix))]
pub fn spent() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeping_costs_nothing_and_work_does() {
        if !cfg!(unix) {
            return;
        }
        let before = spent();
        std::thread::sleep(Duration::from_millis(50));
        let asleep = spent() - before;
        assert!(asleep < Duration::from_millis(25), "{asleep:?}");
        let before = spent();
        let mut sum = 0u64;
        while spent() - before < Duration::from_millis(2) {
            sum = std::hint::black_box(sum.wrapping_add(1));
        }
        assert!(sum > 0);
    }
}
