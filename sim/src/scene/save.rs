//! A scene as bytes, and back, in mid-run.
//!
//! Little-endian: the word `PLGSCENE`, a version, the catalogue's names and fingerprints, the state, and a checksum
//! (FNV-1a of all before it). Everything that decides what comes next is in it: clock, aircraft, bodies with their
//! turbulence and failures, shells, targets, loose things, bursts, numbers of rounds, commands that are not yet due. Wall time that is
//! owed or was lost is not, nor is the record of commands, which starts anew.
//!
//! Invariants others rely on: a restored scene goes on to the bit as the saved one does; hostile bytes are refused with
//! what was expected and found, and never panic, now or in a later step.

use super::arms::Arms;
use super::body::Body;
use super::catalogue::fingerprint;
use super::codec::{Coded, FNV_BASIS, Reader, fnv};
use super::shell::Shell;
use super::target::TargetState;
use super::{
    Catalogue, Command, Freeze, Refused, Roster, SaveError, Scene, Stamped, Surroundings, attitude, place, speed,
};
use crate::aircraft::AircraftState;
use crate::clock::Clock;
use crate::input::{Controls, Levers};
use crate::loose::{Counts, FIRST_ID, Loose, MOST_LOOSE, Piece};
use crate::snapshot::{Mode, StableId};
use crate::utc::UtcTime;
use crate::weapons::Tally;
use std::sync::Arc;

const WORD: &[u8; 8] = b"PLGSCENE";
const VERSION: u32 = 4;
/// Most ids, rounds and events: no run of a scene counts so far, and a sum of two still fits.
const MOST_COUNTED: u64 = 1 << 60;
/// Fastest projectile that is taken back, m/s: above twice what a muzzle and its owner may give.
const FASTEST_MPS: f64 = 1e7;

super::codec::coded_choice!(Mode { Pilot, Track, Slew });

impl Scene {
    /// The scene as it stands between two steps.
    pub fn save(&self) -> Vec<u8> {
        let mut out = WORD.to_vec();
        VERSION.put(&mut out);
        for (kind, name, print) in self.catalogue.prints() {
            (1u8, kind).put(&mut out);
            (name.to_owned(), print).put(&mut out);
        }
        out.push(0);
        self.track.as_ref().map(fingerprint).put(&mut out);
        put_clock(&self.clock, &mut out);
        (self.start, self.aircraft()).put(&mut out);
        (self.controls, self.track_m).put(&mut out);
        (self.mode, self.freeze).put(&mut out);
        (self.height_above_ground_m, self.jumps).put(&mut out);
        (self.levers, self.flown).put(&mut out);
        self.ground_version.put(&mut out);
        self.surroundings.put(&mut out);
        (self.next_id, self.unsettled).put(&mut out);
        self.put_all::<Body>(&self.bodies, &mut out);
        self.put_all::<Shell>(&self.shells, &mut out);
        self.put_all::<TargetState>(&self.targets, &mut out);
        (self.loose.counts, self.loose.pieces().to_vec()).put(&mut out);
        self.bursts.put(&mut out);
        self.fired.iter().map(|(owner, rounds)| (*owner, *rounds)).collect::<Vec<_>>().put(&mut out);
        self.arms.iter().map(|(owner, arms)| (*owner, arms.clone())).collect::<Vec<_>>().put(&mut out);
        self.resting.put(&mut out);
        self.tallies.iter().map(|(of, tally)| (*of, *tally)).collect::<Vec<_>>().put(&mut out);
        self.log.put(&mut out);
        (self.pending.len() as u32).put(&mut out);
        self.pending.iter().for_each(|stamped| stamped.put(&mut out));
        fnv(FNV_BASIS, &out).put(&mut out);
        out
    }

    /// A hash over everything that decides what comes next, entities in the order of their ids.
    pub fn hash(&self) -> u64 {
        fnv(FNV_BASIS, &self.save())
    }

    /// The scene that was saved, with the catalogue that it had, its track in it.
    ///
    /// # Errors
    /// [`SaveError`] says where, what was expected and what was found.
    pub fn restore(bytes: &[u8], catalogue: Arc<Catalogue>) -> Result<Self, SaveError> {
        let mut from = Reader::new(bytes);
        if from.bytes(WORD.len()).ok() != Some(WORD) {
            return Err(from.refuse("expected a saved scene, found something else"));
        }
        let version: u32 = from.take()?;
        if version != VERSION {
            return Err(from.refuse(format_args!("expected version {VERSION}, found {version}")));
        }
        let (body, sum) = bytes.split_at(bytes.len().saturating_sub(8));
        let (expected, found) = (fnv(FNV_BASIS, body), Reader::new(sum).take::<u64>()?);
        if expected != found {
            return Err(from.refuse(format_args!("expected the checksum {expected:016x}, found {found:016x}")));
        }
        take_catalogue(&mut from, &catalogue)?;
        let (expected, found) = (catalogue.track.as_ref().map(fingerprint), from.take::<Option<u64>>()?);
        // A catalogue may hold a track that the scene does not fly.
        if found.is_some() && expected != found {
            return Err(from.refuse("track: expected the one that was saved, found another or none"));
        }
        let track = found.and(catalogue.track.clone());
        let clock = take_clock(&mut from)?;
        let (start, own): (AircraftState, AircraftState) = from.take()?;
        let (controls, track_m): (Controls, f64) = from.take()?;
        let (mode, freeze): (Mode, Freeze) = from.take()?;
        let (height_above_ground_m, jumps) = from.take()?;
        let (levers, flown): (Levers, Option<StableId>) = from.take()?;
        let ground_version: Option<u32> = from.take()?;
        let surroundings: Surroundings = from.take()?;
        let mut scene = Self::within(start, clock.date(), clock.step_hz, surroundings, catalogue);
        for state in [&start, &own] {
            in_bounds(&from, state)?;
        }
        // Numbers that were good are kept to the bit.
        scene.start = start;
        scene.set_aircraft(own);
        (scene.clock, scene.controls, scene.track, scene.track_m) = (clock, controls.checked(), track, track_m);
        (scene.mode, scene.freeze) = (mode, freeze);
        (scene.height_above_ground_m, scene.jumps) = (height_above_ground_m, jumps);
        let (next_id, unsettled) = from.take::<(u64, bool)>()?;
        if !(2..=MOST_COUNTED).contains(&next_id) {
            return Err(from.refuse(format_args!("expected a next id in 2..={MOST_COUNTED}, found {next_id}")));
        }
        scene.next_id = next_id;
        (scene.levers, scene.flown) = (levers.checked(), flown);
        scene.ground_version = ground_version;
        scene.take_entities(&mut from)?;
        if flown.is_some_and(|id| super::found(&scene.bodies, id).is_none()) {
            return Err(from.refuse("flown: expected a body of the scene"));
        }
        scene.unsettled = unsettled;
        scene.take_rest(&mut from)?;
        if from.left() != 8 {
            return Err(
                from.refuse(format_args!("expected the end, found {} bytes more", from.left().saturating_sub(8)))
            );
        }
        Ok(scene)
    }

    fn put_all<C: Coded + hecs::Component>(&self, roster: &Roster, out: &mut Vec<u8>) {
        (roster.len() as u32).put(out);
        let all = self.ecs.view::<&C>();
        for (id, entity) in roster {
            // Listed, so there.
            if let Some(one) = all.get(*entity) {
                id.put(out);
                one.put(out);
            }
        }
    }

    fn take_entities(&mut self, from: &mut Reader<'_>) -> Result<(), SaveError> {
        let mut used = Vec::new();
        for (id, body) in take_all::<Body>(from, self.next_id, &mut used)? {
            let models = &self.catalogue.models;
            let model = models
                .get(body.model as usize)
                .ok_or_else(|| from.refuse("body: expected a model of the catalogue"))?;
            body.check(&model.thing).map_err(|why| from.refuse(why))?;
            let entity = self.ecs.spawn((id, body));
            self.bodies.push((id, entity));
        }
        for (id, shell) in take_all::<Shell>(from, self.next_id, &mut used)? {
            if shell.kind as usize >= self.catalogue.projectiles.len() || shell.age_s < 0.0 {
                return Err(from.refuse("shell: expected a projectile of the catalogue and an age of 0 or more"));
            }
            if shell.load.is_some_and(|load| load.weapon as usize >= self.catalogue.weapons.len()) {
                return Err(from.refuse("shell: expected a weapon of the catalogue"));
            }
            place("shell.position_m", shell.position_m()).map_err(|why| from.refuse(why))?;
            let found = shell.velocity_mps().length();
            if found > FASTEST_MPS {
                return Err(from.refuse(format_args!("shell: expected at most {FASTEST_MPS} m/s, found {found}")));
            }
            let entity = self.ecs.spawn((id, shell));
            self.shells.push((id, entity));
        }
        let targets = take_all::<TargetState>(from, self.next_id, &mut used)?;
        for (_, target) in &targets {
            if target.shape as usize >= self.catalogue.shapes.len() {
                return Err(from.refuse("target: expected a shape of the catalogue"));
            }
            if target.kind.is_some_and(|kind| kind as usize >= self.catalogue.kinds.len()) {
                return Err(from.refuse("target: expected a kind of the catalogue"));
            }
            target.check().map_err(|why| from.refuse(why))?;
        }
        self.enlist_targets(targets);
        self.take_loose(from)?;
        used.sort_unstable();
        match used.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(from.refuse(format_args!("expected ids that are used once, found {} again", pair[0].0))),
            None => Ok(()),
        }
    }

    fn take_loose(&mut self, from: &mut Reader<'_>) -> Result<(), SaveError> {
        let counts: Counts = from.take()?;
        if [counts.named, counts.put_back, counts.forgotten].iter().any(|count| *count > MOST_COUNTED) {
            return Err(from.refuse(format_args!("loose: expected counts of at most {MOST_COUNTED}")));
        }
        let pieces = take_all::<Piece>(from, FIRST_ID + counts.named, &mut Vec::new())?;
        if pieces.len() > MOST_LOOSE || pieces.iter().any(|(id, piece)| id.0 < FIRST_ID || !piece.is_sound()) {
            return Err(
                from.refuse(format_args!("loose: expected up to {MOST_LOOSE} things with numbers they can have"))
            );
        }
        for (_, piece) in &pieces {
            place("loose.position_m", piece.position_m).map_err(|why| from.refuse(why))?;
        }
        self.loose = Loose::of(pieces, counts);
        Ok(())
    }

    fn take_rest(&mut self, from: &mut Reader<'_>) -> Result<(), SaveError> {
        let refuse = |from: &Reader<'_>, why: Refused| from.refuse(why);
        self.bursts = from.take()?;
        for burst in &self.bursts {
            burst.check(self.clock.time_s(), self.clock.step_s()).map_err(|why| refuse(from, why))?;
            let weapons = self.catalogue.weapons.len();
            let beyond = burst.load.is_some_and(|load| load.weapon as usize >= weapons);
            if burst.projectile as usize >= self.catalogue.projectiles.len() || beyond {
                return Err(from.refuse("burst: expected a projectile of the catalogue"));
            }
        }
        self.fired = from.take::<Vec<(StableId, u64)>>()?.into_iter().collect();
        self.arms = from.take::<Vec<(StableId, Arms)>>()?.into_iter().collect();
        for arms in self.arms.values() {
            arms.check(&self.catalogue).map_err(|why| refuse(from, why))?;
        }
        self.resting = from.take()?;
        let weapons = self.catalogue.weapons.len();
        for one in &self.resting {
            one.check(weapons).map_err(|why| refuse(from, why))?;
        }
        self.tallies = from.take::<Vec<((StableId, u32), Tally)>>()?.into_iter().collect();
        if self.tallies.keys().any(|(_, weapon)| *weapon as usize >= weapons) {
            return Err(from.refuse("tally: expected a weapon of the catalogue"));
        }
        let counts = |tally: &Tally| [tally.released, tally.hits, tally.kills, tally.duds, tally.lost, tally.measured];
        if self.tallies.values().any(|tally| counts(tally).iter().any(|count| *count > MOST_COUNTED)) {
            return Err(from.refuse(format_args!("tally: expected counts of at most {MOST_COUNTED}")));
        }
        self.log = from.take()?;
        if self.fired.values().any(|rounds| *rounds > MOST_COUNTED) || self.log.counted > MOST_COUNTED {
            return Err(from.refuse(format_args!("expected at most {MOST_COUNTED} rounds and events")));
        }
        self.pending = from.take::<Vec<Stamped>>()?.into();
        let rises = self.pending.iter().zip(self.pending.iter().skip(1)).all(|(a, b)| a.step <= b.step);
        let late = self.pending.front().is_some_and(|first| first.step < self.clock.step());
        if !rises || late {
            return Err(from.refuse("expected commands whose steps rise and are still to come"));
        }
        let pilot =
            |stamped: &Stamped| matches!(stamped.command, Command::Pilot(_)) && !stamped.command.concerns_scene();
        if self.pending.iter().any(pilot) {
            return Err(from.refuse("expected commands that concern the scene"));
        }
        Ok(())
    }
}

fn in_bounds(from: &Reader<'_>, state: &AircraftState) -> Result<(), SaveError> {
    place("aircraft.position_m", state.position_m).map_err(|why| from.refuse(why))?;
    speed("aircraft.velocity_mps", state.velocity_mps * 0.999_999).map_err(|why| from.refuse(why))?;
    attitude("aircraft.attitude", state.attitude).map_err(|why| from.refuse(why))?;
    Ok(())
}

fn take_all<C: Coded>(
    from: &mut Reader<'_>,
    next_id: u64,
    used: &mut Vec<StableId>,
) -> Result<Vec<(StableId, C)>, SaveError> {
    let mut last = StableId(1);
    let mut all = Vec::new();
    for _ in 0..from.count()? {
        let id: StableId = from.take()?;
        if id <= last || id.0 >= next_id {
            let low = last.0 + 1;
            return Err(from.refuse(format_args!("expected an id in {low}..{next_id}, found {}", id.0)));
        }
        last = id;
        used.push(id);
        all.push((id, from.take()?));
    }
    Ok(all)
}

fn take_catalogue(from: &mut Reader<'_>, catalogue: &Catalogue) -> Result<(), SaveError> {
    const KINDS: [&str; 5] = ["model", "projectile", "shape", "weapon", "target"];
    let mut ours = catalogue.prints();
    while from.take()? {
        let kind: u8 = from.take()?;
        let (name, print): (String, u64) = from.take()?;
        let what = KINDS.get(usize::from(kind)).copied().unwrap_or("thing");
        match ours.next() {
            Some(found) if found == (kind, name.as_str(), print) => {}
            Some((_, found, _)) if found == name => {
                return Err(from.refuse(format_args!(
                    "catalogue: expected the {what} {name} that was saved, found a changed one"
                )));
            }
            found => {
                let found = found.map_or("none", |(_, name, _)| name);
                return Err(from.refuse(format_args!("catalogue: expected the {what} {name}, found {found}")));
            }
        }
    }
    match ours.next() {
        Some((_, name, _)) => Err(from.refuse(format_args!("catalogue: expected its end, found {name}"))),
        None => Ok(()),
    }
}

/// What wall time owes or lost is not the scene's.
fn put_clock(clock: &Clock, out: &mut Vec<u8>) {
    (clock.step_hz, clock.step).put(out);
    (clock.rate, clock.paused).put(out);
    (clock.day_rate, clock.date_base).put(out);
    clock.date_base_step.put(out);
}

fn take_clock(from: &mut Reader<'_>) -> Result<Clock, SaveError> {
    let (step_hz, step): (u32, u64) = from.take()?;
    let (rate, paused): (f64, bool) = from.take()?;
    let (day_rate, date_base): (f64, UtcTime) = from.take()?;
    let date_base_step: u64 = from.take()?;
    let mut clock = Clock::new(step_hz, date_base);
    clock.set_rate(rate);
    clock.set_day_rate(day_rate);
    // 2^50 steps are 300,000 years at 120 a second, and exact as a float.
    let good = clock.step_hz == step_hz && clock.rate == rate && clock.day_rate == day_rate;
    if !good || date_base_step > step || step >= 1 << 50 {
        return Err(from.refuse("clock: expected rates and steps within their bounds"));
    }
    Ok(Clock { step, paused, date_base, date_base_step, ..clock })
}
