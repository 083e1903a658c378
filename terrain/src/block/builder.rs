//! A small pool of threads that makes payloads, meshes and light maps, nearest first.
//!
//! The render thread asks and collects; it never waits unless it wants to (lockstep). A request that is no longer wanted
//! is withdrawn before its turn comes. Each request names the landscape to make it from, and comes back with its number.

use super::payload::{Landscape, Mesh, Payload};
use crate::block::light;
use crate::grid::BlockIndex;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What to make.
#[allow(missing_docs, reason = "the fields say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Job {
    /// A block's payload, lit from a direction.
    Payload { block: BlockIndex, to_sun: DVec3 },
    /// A block's mesh for a ring.
    Mesh { block: BlockIndex, ring: usize },
    /// A block's light map for another sun.
    Light { block: BlockIndex, to_sun: DVec3 },
}

/// What was made.
#[allow(missing_docs, reason = "the fields say themselves what they are")]
#[derive(Debug)]
pub enum Built {
    /// See [`Job::Payload`].
    Payload(Box<Payload>),
    /// See [`Job::Mesh`].
    Mesh { block: BlockIndex, ring: usize, mesh: Mesh },
    /// See [`Job::Light`].
    Light { block: BlockIndex, to_sun: DVec3, light: Box<[u8]> },
}

/// See the module.
pub struct Builder {
    shared: Arc<Shared>,
    results: mpsc::Receiver<(u64, Built)>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared {
    queue: Mutex<Queue>,
    wake: Condvar,
    /// Wall time spent making things, nanoseconds: sum and worst.
    spent_ns: AtomicU64,
    worst_ns: AtomicU64,
    made: AtomicU64,
}

#[derive(Default)]
struct Queue {
    /// The nearest is last.
    jobs: Vec<Asked>,
    sorted: bool,
    closed: bool,
}

struct Asked {
    distance_m: f64,
    job: Job,
    number: u64,
    landscape: Arc<Landscape>,
}

/// What building has cost so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BuildCost {
    /// Things made.
    pub made: u64,
    /// Mean wall time to make one, milliseconds; on a busy machine more than the work itself.
    pub mean_ms: f64,
    /// Longest, milliseconds.
    pub max_ms: f64,
}

impl Job {
    /// The block it is for.
    pub fn block(&self) -> BlockIndex {
        match *self {
            Self::Payload { block, .. } | Self::Mesh { block, .. } | Self::Light { block, .. } => block,
        }
    }
}

impl Builder {
    /// Starts `threads` builders (at least one).
    pub fn new(threads: usize) -> Self {
        let shared = Arc::new(Shared {
            queue: Mutex::default(),
            wake: Condvar::new(),
            spent_ns: AtomicU64::new(0),
            worst_ns: AtomicU64::new(0),
            made: AtomicU64::new(0),
        });
        let (sender, results) = mpsc::channel();
        let threads = (0..threads.max(1))
            .map(|_| {
                let (shared, sender) = (shared.clone(), sender.clone());
                std::thread::spawn(move || work(&shared, &sender))
            })
            .collect();
        Self { shared, results, threads }
    }

    /// Asks for jobs on a landscape, each with its distance from the eye in metres; what is made comes back with the number.
    pub fn request(&self, number: u64, landscape: &Arc<Landscape>, jobs: impl IntoIterator<Item = (f64, Job)>) {
        let mut queue = self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let before = queue.jobs.len();
        queue.jobs.extend(jobs.into_iter().map(|(distance_m, job)| Asked {
            distance_m,
            job,
            number,
            landscape: landscape.clone(),
        }));
        if queue.jobs.len() > before {
            queue.sorted = false;
            self.shared.wake.notify_all();
        }
    }

    /// Withdraws the waiting jobs that are no longer wanted; says which, with their numbers.
    pub fn withdraw(&self, mut unwanted: impl FnMut(u64, &Job) -> bool) -> Vec<(u64, Job)> {
        let mut queue = self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let mut gone = Vec::new();
        queue.jobs.retain(|asked| {
            let leave = unwanted(asked.number, &asked.job);
            if leave {
                gone.push((asked.number, asked.job));
            }
            !leave
        });
        gone
    }

    /// The next thing made, if one is ready.
    pub fn try_take(&self) -> Option<(u64, Built)> {
        self.results.try_recv().ok()
    }

    /// The next thing made; waits for it. `None` if a thread has ended, which only a fault in making things can do.
    pub fn wait(&self) -> Option<(u64, Built)> {
        loop {
            match self.results.recv_timeout(Duration::from_millis(200)) {
                Ok(built) => return Some(built),
                Err(mpsc::RecvTimeoutError::Disconnected) => return None,
                Err(mpsc::RecvTimeoutError::Timeout) if self.threads.iter().any(JoinHandle::is_finished) => {
                    return None;
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// What building has cost.
    pub fn cost(&self) -> BuildCost {
        let made = self.shared.made.load(Ordering::Relaxed);
        let ms = |ns: &AtomicU64| ns.load(Ordering::Relaxed) as f64 * 1e-6;
        BuildCost { made, mean_ms: ms(&self.shared.spent_ns) / made.max(1) as f64, max_ms: ms(&self.shared.worst_ns) }
    }
}

impl Drop for Builder {
    fn drop(&mut self) {
        let mut queue = self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
        queue.closed = true;
        queue.jobs.clear();
        drop(queue);
        self.shared.wake.notify_all();
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn work(shared: &Shared, results: &mpsc::Sender<(u64, Built)>) {
    loop {
        let asked = {
            let mut queue = shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
            loop {
                if queue.closed {
                    return;
                }
                if !queue.sorted {
                    queue.jobs.sort_by(|a, b| b.distance_m.total_cmp(&a.distance_m));
                    queue.sorted = true;
                }
                match queue.jobs.pop() {
                    Some(asked) => break asked,
                    None => queue = shared.wake.wait(queue).unwrap_or_else(PoisonError::into_inner),
                }
            }
        };
        let start = Instant::now();
        let built = make(&asked.landscape, asked.job);
        let ns = start.elapsed().as_nanos() as u64;
        shared.spent_ns.fetch_add(ns, Ordering::Relaxed);
        shared.worst_ns.fetch_max(ns, Ordering::Relaxed);
        shared.made.fetch_add(1, Ordering::Relaxed);
        if results.send((asked.number, built)).is_err() {
            return;
        }
    }
}

/// Does one job; also what a builder's thread does.
pub fn make(landscape: &Landscape, job: Job) -> Built {
    match job {
        Job::Payload { block, to_sun } => Built::Payload(Box::new(landscape.payload(block, to_sun))),
        Job::Mesh { block, ring } => Built::Mesh { block, ring, mesh: landscape.mesh(block, ring) },
        Job::Light { block, to_sun } => {
            let ground = &landscape.ground;
            Built::Light { block, to_sun, light: light::light_map(ground.field(), ground.pyramid(), block, to_sun) }
        }
    }
}
