//! A world from its folder, or the embedded one, ready to be asked and drawn.

use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use sim::case::{Case, DEFAULT_WORLD};
use std::path::Path;
use std::sync::Arc;
use terrain::block::ground_map::Climate;
use terrain::block::{Landscape, Rings};
use terrain::features::by_block::StripsByBlock;
use terrain::store::World;
use terrain::{Ground, RingMasks};

/// The world in a folder; without one the embedded Issyk-Kul world, baked on first use.
///
/// # Errors
/// [`Failure::Failed`] if the folder is no world, or the embedded one cannot be baked.
pub fn open(path: Option<&Path>) -> Result<World, Failure> {
    if let Some(path) = path {
        return World::read(path).map_err(|error| Failure::while_doing("reading the world", error));
    }
    let bar = Progress::new("baking the default world, once");
    let default = terrain::bake::default_world(&mut |_, share| bar.show(share.into()))
        .map_err(|error| Failure::while_doing("baking the default world", error))?;
    drop(bar);
    if let Err(reason) = &default.kept {
        output::tell(format_args!("poligon: {reason}"));
    }
    Ok(default.world)
}

/// The world that a case names, if it names one; `default` is the embedded one.
///
/// # Errors
/// [`Failure::Misuse`] if what is named is no world; [`Failure::Failed`] if the embedded one cannot be baked.
pub fn of_case(case: &Case) -> Result<Option<World>, Failure> {
    match &case.run.world {
        None => Ok(None),
        Some(path) if path == Path::new(DEFAULT_WORLD) => open(None).map(Some),
        Some(path) => World::read(path)
            .map(Some)
            .map_err(|error| Failure::Misuse(format!("{}: run.world: {error}", case.file.display()))),
    }
}

/// All that blocks are made from, with masks for the limits of `rings`.
pub fn landscape(world: &World, rings: &Rings) -> Arc<Landscape> {
    let masks = world
        .ring_masks()
        .filter(|masks| masks.limits_m == rings.limits_m)
        .unwrap_or_else(|| RingMasks::new(&world.field, rings.limits_m));
    Arc::new(Landscape {
        ground: Ground::new(world.field.clone()),
        lakes: Arc::new(world.lakes.clone()),
        strips: Arc::new(StripsByBlock::new(world.field.grid(), &world.features)),
        features: world.features.clone(),
        cover: world.cover.clone(),
        imagery: world.imagery.clone(),
        climate: Climate::of(world.projection.centre(), world.info.statistics.mean_m),
        masks,
    })
}
