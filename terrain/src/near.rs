//! What stands near the eye, made tile by tile off the render thread: overlays, objects, plants.
//!
//! The world's plane is cut into square tiles of [`Settings::side_m`], tile (0, 0) at the north-west corner of the grid.
//! Every tile whose nearest point is within [`Settings::reach_m`] of the eye's ground point is wanted. A thread of its own
//! makes what a tile holds, nearest first; the render thread never waits unless [`Settings::wait`] is set. Tiles are
//! asked for a margin before they are wanted, as far ahead as the eye flies in [`LEAD_S`], and kept a margin longer.
//!
//! Invariant: what a tile holds is a function of the tile alone, so neither order nor time nor the eye's path shows. Where
//! the world changes, [`NearTiles::remake`] puts another function in its place: the tiles that it reaches come again, and
//! until then those of before are shown.

use crate::edit::Changed;
use crate::grid::Grid;
use glam::DVec2;
use std::collections::HashMap;
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::thread::JoinHandle;

/// How far ahead in time tiles are asked for, seconds.
pub const LEAD_S: f64 = 2.0;

/// A tile's place: tiles east and south of the world's north-west corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TileIndex {
    /// East.
    pub x: i32,
    /// South.
    pub z: i32,
}

/// How the tiles of one kind are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Side of a tile, metres.
    pub side_m: f64,
    /// Plan distance from the eye within which a tile is wanted, metres.
    pub reach_m: f64,
    /// Most bytes handed out in one update (at least one tile is).
    pub budget_bytes: usize,
    /// Wait for every wanted tile: the same path gives the same pictures.
    pub wait: bool,
}

/// What changed in an update.
#[derive(Debug)]
pub enum Change<T> {
    /// A tile is there; in the place of what it was, if it was there already.
    Arrived(TileIndex, Arc<T>),
    /// A tile is no longer wanted.
    Left(TileIndex),
}

/// See the module. `T` is what a tile holds.
pub struct NearTiles<T> {
    settings: Settings,
    grid: Grid,
    corner: DVec2,
    tiles_x: i32,
    tiles_z: i32,
    state: HashMap<TileIndex, State<T>>,
    shared: Arc<Shared<T>>,
    results: mpsc::Receiver<(u64, TileIndex, T)>,
    thread: Option<JoinHandle<()>>,
    /// Counts the functions that tiles were made by, from 0.
    number: u64,
    bytes: fn(&T) -> usize,
    eye: DVec2,
    late: usize,
}

/// A tile that is wanted.
struct State<T> {
    /// Whether it was handed out.
    shown: bool,
    /// The least number of the function that it may be made by.
    number: u64,
    made: Made<T>,
}

enum Made<T> {
    Asked,
    Ready(Arc<T>),
    HandedOut,
}

/// Makes what a tile holds.
type Make<T> = Box<dyn Fn(TileIndex) -> T + Send>;

/// A tile to make, and by what from now on if that has changed.
type Job<T> = (TileIndex, Option<(u64, Make<T>)>);

struct Shared<T> {
    queue: Mutex<Queue<T>>,
    wake: Condvar,
}

struct Queue<T> {
    /// Plan distance and tile; the nearest is last.
    jobs: Vec<(f64, TileIndex)>,
    /// What tiles are made by from now on, with its number.
    make: Option<(u64, Make<T>)>,
    closed: bool,
}

impl<T: Send + 'static> NearTiles<T> {
    /// Tiles over a grid; `make` makes what a tile holds, `bytes` says what handing it out costs.
    pub fn new(
        grid: &Grid,
        settings: Settings,
        bytes: fn(&T) -> usize,
        make: impl Fn(TileIndex) -> T + Send + 'static,
    ) -> Self {
        let mut maker: (u64, Make<T>) = (0, Box::new(make));
        let queue = Queue { jobs: Vec::new(), make: None, closed: false };
        let shared = Arc::new(Shared { queue: Mutex::new(queue), wake: Condvar::new() });
        let (sender, results) = mpsc::channel();
        let theirs = shared.clone();
        let thread = std::thread::spawn(move || {
            while let Some((tile, other)) = theirs.next() {
                if let Some(other) = other {
                    maker = other;
                }
                let (number, make) = &maker;
                if sender.send((*number, tile, make(tile))).is_err() {
                    return;
                }
            }
        });
        let tiles = |length_m: f64| (length_m / settings.side_m).ceil() as i32;
        Self {
            grid: *grid,
            corner: DVec2::new(grid.west_m, grid.north_m),
            tiles_x: tiles(grid.east_m() - grid.west_m),
            tiles_z: tiles(grid.south_m() - grid.north_m),
            settings,
            state: HashMap::new(),
            shared,
            results,
            thread: Some(thread),
            number: 0,
            bytes,
            eye: DVec2::ZERO,
            late: 0,
        }
    }

    /// How they are kept.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// North-west corner of a tile, metres (x, z).
    pub fn corner_m(&self, tile: TileIndex) -> DVec2 {
        self.corner + DVec2::new(f64::from(tile.x), f64::from(tile.z)) * self.settings.side_m
    }

    /// Plan distance from a point to a tile's nearest point, metres.
    pub fn distance_m(&self, at: DVec2, tile: TileIndex) -> f64 {
        let low = self.corner_m(tile);
        at.clamp(low, low + self.settings.side_m).distance(at)
    }

    /// Tiles within reach that were not there after the last update.
    pub fn late(&self) -> usize {
        self.late
    }

    /// Makes tiles by another function from now on; of those there are, the ones that it is `reached` for are made again. They
    /// are asked for in the next update.
    pub fn remake(&mut self, make: impl Fn(TileIndex) -> T + Send + 'static, reached: impl Fn(TileIndex) -> bool) {
        self.number += 1;
        let number = self.number;
        let mut jobs = Vec::new();
        for (tile, state) in self.state.iter_mut().filter(|(tile, _)| reached(**tile)) {
            state.number = number;
            // One that is asked for already waits in the queue, or comes too early and is asked for again.
            if !matches!(state.made, Made::Asked) {
                state.made = Made::Asked;
                jobs.push((0.0, *tile));
            }
        }
        self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner).make = Some((number, Box::new(make)));
        self.ask(jobs);
    }

    /// The same over a changed ground: those tiles that the change reaches are made again.
    pub fn remake_where(&mut self, changed: &Changed, make: impl Fn(TileIndex) -> T + Send + 'static) {
        let (grid, corner, side_m) = (self.grid, self.corner, self.settings.side_m);
        self.remake(make, |tile| {
            let low = corner + DVec2::new(f64::from(tile.x), f64::from(tile.z)) * side_m;
            changed.reaches_square(&grid, low, low + side_m)
        });
    }

    /// Follows the eye (plan x, z, metres) at a speed, m/s; says which tiles came and went.
    pub fn update(&mut self, eye: DVec2, speed_mps: f64) -> Vec<Change<T>> {
        if eye.is_finite() {
            self.eye = eye.clamp(DVec2::splat(-1e8), DVec2::splat(1e8));
        }
        let eye = self.eye;
        let lead_m = LEAD_S * if speed_mps.is_finite() { speed_mps.abs().min(5_000.0) } else { 0.0 };
        let (reach_m, ask_m) = (self.settings.reach_m, self.settings.reach_m + 200.0 + lead_m);
        let keep_m = ask_m + 400.0;
        let mut changes = Vec::new();
        let gone: Vec<TileIndex> =
            self.state.keys().copied().filter(|tile| self.distance_m(eye, *tile) > keep_m).collect();
        for tile in gone {
            if self.state.remove(&tile).is_some_and(|state| state.shown) {
                changes.push(Change::Left(tile));
            }
        }
        let mut jobs = Vec::new();
        let tile_of = |at_m: f64| (at_m / self.settings.side_m).floor() as i32;
        let (low, high) = (eye - self.corner - ask_m, eye - self.corner + ask_m);
        for z in tile_of(low.y).max(0)..=tile_of(high.y).min(self.tiles_z - 1) {
            for x in tile_of(low.x).max(0)..=tile_of(high.x).min(self.tiles_x - 1) {
                let tile = TileIndex { x, z };
                let distance_m = self.distance_m(eye, tile);
                if distance_m <= ask_m && !self.state.contains_key(&tile) {
                    self.state.insert(tile, State { shown: false, number: self.number, made: Made::Asked });
                    jobs.push((distance_m, tile));
                }
            }
        }
        self.ask(jobs);
        while let Ok((number, tile, made)) = self.results.try_recv() {
            self.take(number, tile, made);
        }
        if self.settings.wait {
            while self.state.values().any(|state| matches!(state.made, Made::Asked)) {
                match self.results.recv() {
                    Ok((number, tile, made)) => self.take(number, tile, made),
                    Err(_) => break,
                }
            }
        }
        self.hand_out(eye, &mut changes);
        self.late =
            self.state.iter().filter(|(tile, state)| !state.shown && self.distance_m(eye, **tile) <= reach_m).count();
        changes
    }

    fn ask(&self, jobs: Vec<(f64, TileIndex)>) {
        let mut queue = self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
        queue.jobs.retain(|(_, tile)| self.state.contains_key(tile));
        if !jobs.is_empty() {
            queue.jobs.extend(jobs);
            // The eye has moved: distances are taken anew.
            for (distance_m, tile) in &mut queue.jobs {
                *distance_m = self.distance_m(self.eye, *tile);
            }
            queue.jobs.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
            self.shared.wake.notify_all();
        }
    }

    fn take(&mut self, number: u64, tile: TileIndex, made: T) {
        match self.state.get_mut(&tile) {
            // One asked for twice, since the eye left and came back, is made twice and handed out once.
            Some(state) if number >= state.number => {
                if matches!(state.made, Made::Asked) {
                    state.made = Made::Ready(Arc::new(made));
                }
            }
            // By a function of before, which was at it when the other came.
            Some(_) => self.ask(vec![(0.0, tile)]),
            None => {}
        }
    }

    fn hand_out(&mut self, eye: DVec2, changes: &mut Vec<Change<T>>) {
        let mut ready: Vec<(f64, TileIndex)> = self
            .state
            .iter()
            .filter(|(_, state)| matches!(state.made, Made::Ready(_)))
            .map(|(tile, _)| (self.distance_m(eye, *tile), *tile))
            .collect();
        ready.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut spent = 0;
        for (_, tile) in ready {
            let Some(state) = self.state.get_mut(&tile) else { continue };
            let Made::Ready(made) = &state.made else { continue };
            spent += (self.bytes)(made);
            if spent > self.settings.budget_bytes && spent > (self.bytes)(made) && !self.settings.wait {
                break;
            }
            changes.push(Change::Arrived(tile, made.clone()));
            (state.shown, state.made) = (true, Made::HandedOut);
        }
    }
}

impl<T> Shared<T> {
    /// The next tile to make, and by what if that has changed.
    fn next(&self) -> Option<Job<T>> {
        let mut queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if queue.closed {
                return None;
            }
            match queue.jobs.pop() {
                Some((_, tile)) => return Some((tile, queue.make.take())),
                None => queue = self.wake.wait(queue).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }
}

impl<T> Drop for NearTiles<T> {
    fn drop(&mut self) {
        let mut queue = self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner);
        queue.closed = true;
        drop(queue);
        self.shared.wake.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn tiles(wait: bool, budget_bytes: usize) -> NearTiles<TileIndex> {
        let grid = Grid::centred(200.0, 4, 4).unwrap();
        let settings = Settings { side_m: 1_500.0, reach_m: 4_000.0, budget_bytes, wait };
        NearTiles::new(&grid, settings, |_| 10, |tile| tile)
    }

    #[test]
    fn waiting_shows_exactly_what_is_within_reach_and_a_margin() {
        let mut tiles = tiles(true, 1 << 20);
        let mut shown = HashSet::new();
        for step in 0..60 {
            let eye = DVec2::new(-14_000.0 + 450.0 * f64::from(step), 300.0 * f64::from(step % 7));
            for change in tiles.update(eye, 100.0) {
                match change {
                    Change::Arrived(tile, made) => {
                        assert_eq!(*made, tile);
                        assert!(shown.insert(tile), "{tile:?} came twice");
                    }
                    Change::Left(tile) => assert!(shown.remove(&tile), "{tile:?} left and was not there"),
                }
            }
            assert_eq!(tiles.late(), 0);
            for z in 0..16 {
                for x in 0..16 {
                    let tile = TileIndex { x, z };
                    let distance_m = tiles.distance_m(eye, tile);
                    if distance_m <= 4_000.0 {
                        assert!(shown.contains(&tile), "{tile:?} at {distance_m} m");
                    } else if distance_m > 4_000.0 + 800.0 {
                        assert!(!shown.contains(&tile), "{tile:?} at {distance_m} m");
                    }
                }
            }
        }
    }

    #[test]
    fn tiles_made_anew_take_the_place_of_those_shown_and_no_other_does() {
        for wait in [true, false] {
            let grid = Grid::centred(200.0, 4, 4).unwrap();
            let settings = Settings { side_m: 1_500.0, reach_m: 4_000.0, budget_bytes: 1 << 20, wait };
            let mut tiles = NearTiles::new(&grid, settings, |_| 10, |tile| (tile, 0));
            let mut shown: HashMap<TileIndex, u32> = HashMap::new();
            let reached = |tile: TileIndex| (tile.x + tile.z) % 3 == 0;
            // What a tile must hold: the last function that reached it while it was there, or any later one.
            for step in 0..40_u32 {
                if step.is_multiple_of(4) {
                    tiles.remake(move |tile| (tile, step), reached);
                }
                let quiet = step >= 36;
                for _ in 0..if wait {
                    1
                } else if quiet {
                    300
                } else {
                    2
                } {
                    let eye = DVec2::new(-6_000.0 + 300.0 * f64::from(step.min(36)), 0.0);
                    for change in tiles.update(eye, 0.0) {
                        match change {
                            Change::Arrived(tile, made) => {
                                assert_eq!(made.0, tile);
                                let before = shown.insert(tile, made.1);
                                assert!(before.is_none_or(|before| before < made.1 && reached(tile)), "{tile:?}");
                            }
                            Change::Left(tile) => assert!(shown.remove(&tile).is_some(), "{tile:?}"),
                        }
                    }
                    std::thread::sleep(std::time::Duration::from_micros(if quiet && !wait { 200 } else { 0 }));
                }
                if wait || step == 39 {
                    let last = step / 4 * 4;
                    assert!(shown.iter().filter(|(tile, _)| reached(**tile)).all(|(_, by)| *by == last), "{step}");
                    assert_eq!(tiles.late(), 0);
                }
            }
            assert!(shown.len() > 10);
        }
    }

    #[test]
    fn a_small_budget_hands_out_one_tile_an_update_and_all_in_the_end() {
        let mut tiles = tiles(false, 1);
        let mut arrived = 0;
        for _ in 0..400 {
            let changes = tiles.update(DVec2::ZERO, 0.0);
            assert!(changes.len() <= 1);
            arrived += changes.len();
            std::thread::sleep(std::time::Duration::from_micros(200));
        }
        assert_eq!(tiles.late(), 0);
        assert!(arrived > 20);
        assert!(tiles.update(DVec2::NAN, f64::NAN).is_empty());
    }

    #[test]
    fn a_tile_that_was_made_twice_arrives_once() {
        let mut tiles = tiles(false, 1 << 20);
        let tile = TileIndex { x: 3, z: 3 };
        let arrived = |tiles: &mut NearTiles<TileIndex>| {
            let mut changes = Vec::new();
            tiles.take(0, tile, tile);
            tiles.hand_out(DVec2::ZERO, &mut changes);
            changes.len()
        };
        assert_eq!(arrived(&mut tiles), 0, "nobody asked");
        tiles.state.insert(tile, State { shown: false, number: 0, made: Made::Asked });
        assert_eq!(arrived(&mut tiles), 1);
        assert_eq!(arrived(&mut tiles), 0);
    }
}
