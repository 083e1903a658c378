//! What stands near the eye, made tile by tile off the render thread: overlays, objects, plants.
//!
//! The world's plane is cut into square tiles of [`Settings::side_m`], tile (0, 0) at the north-west corner of the grid.
//! Every tile whose nearest point is within [`Settings::reach_m`] of the eye's ground point is wanted. A thread of its own
//! makes what a tile holds, nearest first; the render thread never waits unless [`Settings::wait`] is set. Tiles are
//! asked for a margin before they are wanted, as far ahead as the eye flies in [`LEAD_S`], and kept a margin longer.
//!
//! Invariant: what a tile holds is a function of the tile alone, so neither order nor time nor the eye's path shows.

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
    /// A tile is there.
    Arrived(TileIndex, Arc<T>),
    /// A tile is no longer wanted.
    Left(TileIndex),
}

/// See the module. `T` is what a tile holds.
pub struct NearTiles<T> {
    settings: Settings,
    corner: DVec2,
    tiles_x: i32,
    tiles_z: i32,
    state: HashMap<TileIndex, State<T>>,
    shared: Arc<Shared>,
    results: mpsc::Receiver<(TileIndex, T)>,
    thread: Option<JoinHandle<()>>,
    bytes: fn(&T) -> usize,
    eye: DVec2,
    late: usize,
}

enum State<T> {
    Asked,
    Ready(Arc<T>),
    Shown,
}

#[derive(Default)]
struct Shared {
    queue: Mutex<Queue>,
    wake: Condvar,
}

#[derive(Default)]
struct Queue {
    /// Plan distance and tile; the nearest is last.
    jobs: Vec<(f64, TileIndex)>,
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
        let shared = Arc::new(Shared::default());
        let (sender, results) = mpsc::channel();
        let theirs = shared.clone();
        let thread = std::thread::spawn(move || {
            while let Some(tile) = theirs.next() {
                if sender.send((tile, make(tile))).is_err() {
                    return;
                }
            }
        });
        let tiles = |length_m: f64| (length_m / settings.side_m).ceil() as i32;
        Self {
            corner: DVec2::new(grid.west_m, grid.north_m),
            tiles_x: tiles(grid.east_m() - grid.west_m),
            tiles_z: tiles(grid.south_m() - grid.north_m),
            settings,
            state: HashMap::new(),
            shared,
            results,
            thread: Some(thread),
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
            if matches!(self.state.remove(&tile), Some(State::Shown)) {
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
                    self.state.insert(tile, State::Asked);
                    jobs.push((distance_m, tile));
                }
            }
        }
        self.ask(jobs);
        while let Ok((tile, made)) = self.results.try_recv() {
            self.take(tile, made);
        }
        if self.settings.wait {
            while self.state.values().any(|state| matches!(state, State::Asked)) {
                match self.results.recv() {
                    Ok((tile, made)) => self.take(tile, made),
                    Err(_) => break,
                }
            }
        }
        self.hand_out(eye, &mut changes);
        self.late = self
            .state
            .iter()
            .filter(|(tile, state)| !matches!(state, State::Shown) && self.distance_m(eye, **tile) <= reach_m)
            .count();
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

    fn take(&mut self, tile: TileIndex, made: T) {
        // One asked for twice, since the eye left and came back, is made twice and handed out once.
        if let Some(state @ State::Asked) = self.state.get_mut(&tile) {
            *state = State::Ready(Arc::new(made));
        }
    }

    fn hand_out(&mut self, eye: DVec2, changes: &mut Vec<Change<T>>) {
        let mut ready: Vec<(f64, TileIndex)> = self
            .state
            .iter()
            .filter(|(_, state)| matches!(state, State::Ready(_)))
            .map(|(tile, _)| (self.distance_m(eye, *tile), *tile))
            .collect();
        ready.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut spent = 0;
        for (_, tile) in ready {
            let Some(state) = self.state.get_mut(&tile) else { continue };
            let State::Ready(made) = state else { continue };
            spent += (self.bytes)(made);
            if spent > self.settings.budget_bytes && spent > (self.bytes)(made) && !self.settings.wait {
                break;
            }
            changes.push(Change::Arrived(tile, made.clone()));
            *state = State::Shown;
        }
    }
}

impl Shared {
    fn next(&self) -> Option<TileIndex> {
        let mut queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if queue.closed {
                return None;
            }
            match queue.jobs.pop() {
                Some((_, tile)) => return Some(tile),
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
            tiles.take(tile, tile);
            tiles.hand_out(DVec2::ZERO, &mut changes);
            changes.len()
        };
        assert_eq!(arrived(&mut tiles), 0, "nobody asked");
        tiles.state.insert(tile, State::Asked);
        assert_eq!(arrived(&mut tiles), 1);
        assert_eq!(arrived(&mut tiles), 0);
    }
}
