//! What may grow: a table, and the choice among it by cover, latitude, height and a number of a hash.
//!
//! Heights and belts come from botanical handbooks, named beside each tree and juniper; shrubs, steepest slopes and weights are
//! estimates. Colours are linear albedos of whole crowns as seen from the air, dark because leaves shade each other (conifer
//! stands reflect 5 to 10 % of green light, broadleaf stands 8 to 15 %: T. Oke, Boundary Layer Climates, 1987, table 1.1 gives
//! 5-15 % and 15-20 % of all light).
//!
//! Invariant: a species' number is its place in [`SPECIES`]; only f32 comparisons and sums decide, so the choice is the same
//! on every machine.

use terrain::block::ground_map::Climate;
use terrain::features::cover::CoverClass;

/// Which model a species is drawn with.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Narrow cone to the ground: spruce, fir.
    Spire = 0,
    /// Broad cone to the ground.
    Conifer = 1,
    /// Bare trunk below a loose, rounded crown.
    Pine = 2,
    /// Round crown.
    Broadleaf = 3,
    /// Column.
    Poplar = 4,
    /// Round, from the ground.
    Bush = 5,
}

/// Number of [`Shape`]s.
pub const SHAPES: usize = 6;

/// A kind of plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Species {
    /// Botanical name.
    pub name: &'static str,
    /// Its model.
    pub shape: Shape,
    /// Least and greatest height of what is placed, metres.
    pub height_m: [f32; 2],
    /// Crown width over height.
    pub width: f32,
    /// Heights where it grows, over the height of the tree line.
    pub belt: [f32; 2],
    /// Latitudes where it grows, degrees without sign.
    pub latitudes_deg: [f32; 2],
    /// How dry the low ground may be, [`Climate::dryness`].
    pub dryness: [f32; 2],
    /// Sine of the steepest slope.
    pub steepest: f32,
    /// Weight on conifer, broadleaf, mixed forest, scrub, open and built-up ground.
    pub weights: [f32; 6],
    /// Linear albedo of the crown.
    pub colour: [f32; 3],
}

/// Kinds of ground as columns of [`Species::weights`].
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    Conifer = 0,
    Broadleaf = 1,
    Mixed = 2,
    Scrub = 3,
    Open = 4,
    BuiltUp = 5,
}

const ALL_DRYNESS: [f32; 2] = [0.0, 1.0];
const MOIST: [f32; 2] = [0.0, 0.6];
const DRY: [f32; 2] = [0.4, 1.0];

/// All species. Their order is part of every world's looks.
pub const SPECIES: [Species; 14] = [
    // 1,200-3,500 m, cool northern slopes, to 60 m, crown cylindric or narrowly pyramidal: Flora of China vol. 4, 1999.
    // Stands of the Kyrgyz Tian Shan are 20-35 m tall; the tree line there is near 3,000 m.
    Species {
        name: "Picea schrenkiana",
        shape: Shape::Spire,
        height_m: [14.0, 34.0],
        width: 0.24,
        belt: [0.4, 1.1],
        latitudes_deg: [35.0, 48.0],
        dryness: DRY,
        steepest: 0.75,
        weights: [1.0, 0.0, 0.6, 0.0, 0.5, 0.05],
        colour: [0.034, 0.053, 0.024],
    },
    // To 50 m, commonly 25-40 m; in the Alps to the tree line: Farjon, A Handbook of the World's Conifers, 2010.
    Species {
        name: "Picea abies",
        shape: Shape::Conifer,
        height_m: [16.0, 36.0],
        width: 0.30,
        belt: [0.0, 1.1],
        latitudes_deg: [41.0, 70.0],
        dryness: MOIST,
        steepest: 0.75,
        weights: [1.0, 0.0, 0.5, 0.0, 0.2, 0.15],
        colour: [0.036, 0.057, 0.023],
    },
    // To 55 m, commonly 25-40 m; montane, below the spruce: Farjon 2010.
    Species {
        name: "Abies alba",
        shape: Shape::Spire,
        height_m: [18.0, 38.0],
        width: 0.26,
        belt: [0.2, 0.85],
        latitudes_deg: [40.0, 52.0],
        dryness: MOIST,
        steepest: 0.7,
        weights: [0.35, 0.0, 0.3, 0.0, 0.05, 0.05],
        colour: [0.031, 0.048, 0.023],
    },
    // To 35 m, 5-25 m in the mountains: Farjon 2010.
    Species {
        name: "Pinus sylvestris",
        shape: Shape::Pine,
        height_m: [10.0, 26.0],
        width: 0.40,
        belt: [0.0, 0.95],
        latitudes_deg: [37.0, 70.0],
        dryness: MOIST,
        steepest: 0.8,
        weights: [0.45, 0.0, 0.35, 0.0, 0.25, 0.15],
        colour: [0.046, 0.064, 0.028],
    },
    // Uncinata in the Pyrenees: to 20 m, 1,400-2,700 m: Farjon 2010.
    Species {
        name: "Pinus mugo subsp. uncinata",
        shape: Shape::Pine,
        height_m: [6.0, 16.0],
        width: 0.46,
        belt: [0.65, 1.15],
        latitudes_deg: [40.0, 48.0],
        dryness: MOIST,
        steepest: 0.85,
        weights: [0.6, 0.0, 0.2, 0.0, 0.4, 0.0],
        colour: [0.042, 0.060, 0.028],
    },
    // Prostrate to 3-5 m about the tree line: Farjon 2010 (subsp. mugo).
    Species {
        name: "Pinus mugo subsp. mugo",
        shape: Shape::Bush,
        height_m: [1.5, 3.5],
        width: 1.3,
        belt: [0.8, 1.2],
        latitudes_deg: [40.0, 51.0],
        dryness: MOIST,
        steepest: 0.9,
        weights: [0.0, 0.0, 0.0, 1.0, 0.3, 0.0],
        colour: [0.038, 0.054, 0.022],
    },
    // 25-35 (-50) m; to 1,000 m in the Carpathians, 1,700 m in the Pyrenees: European Atlas of Forest Tree Species, 2016.
    Species {
        name: "Fagus sylvatica",
        shape: Shape::Broadleaf,
        height_m: [16.0, 32.0],
        width: 0.58,
        belt: [0.05, 0.80],
        latitudes_deg: [38.0, 59.0],
        dryness: MOIST,
        steepest: 0.75,
        weights: [0.0, 1.0, 0.6, 0.0, 0.2, 0.3],
        colour: [0.050, 0.080, 0.025],
    },
    // 20-40 m, low ground: European Atlas of Forest Tree Species, 2016 (Q. robur, Q. petraea).
    Species {
        name: "Quercus robur",
        shape: Shape::Broadleaf,
        height_m: [14.0, 28.0],
        width: 0.75,
        belt: [0.0, 0.55],
        latitudes_deg: [36.0, 61.0],
        dryness: MOIST,
        steepest: 0.6,
        weights: [0.0, 0.8, 0.4, 0.0, 0.6, 0.6],
        colour: [0.052, 0.072, 0.024],
    },
    // 15-25 m, first on open ground, near to the tree line: European Atlas of Forest Tree Species, 2016 (B. pendula).
    Species {
        name: "Betula pendula",
        shape: Shape::Broadleaf,
        height_m: [8.0, 20.0],
        width: 0.42,
        belt: [0.0, 0.98],
        latitudes_deg: [38.0, 70.0],
        dryness: ALL_DRYNESS,
        steepest: 0.75,
        weights: [0.012, 0.35, 0.3, 0.05, 0.3, 0.3],
        colour: [0.066, 0.084, 0.028],
    },
    // 20-30 m columns along ditches and streets of Central Asia and Europe: Flora of China vol. 4 (P. nigra var. italica to
    // 30 m; P. laurifolia and P. talassica in the valleys of the Tian Shan).
    Species {
        name: "Populus nigra var. italica",
        shape: Shape::Poplar,
        height_m: [14.0, 28.0],
        width: 0.20,
        belt: [0.0, 0.75],
        latitudes_deg: [30.0, 56.0],
        dryness: ALL_DRYNESS,
        steepest: 0.25,
        weights: [0.0, 0.1, 0.0, 0.0, 0.3, 0.8],
        colour: [0.056, 0.076, 0.027],
    },
    // Elms, apples and willows of Central Asian towns and valley floors: 8-20 m (Flora of China vols 4, 5, 9).
    Species {
        name: "Ulmus pumila",
        shape: Shape::Broadleaf,
        height_m: [7.0, 18.0],
        width: 0.65,
        belt: [0.0, 0.75],
        latitudes_deg: [30.0, 50.0],
        dryness: DRY,
        steepest: 0.5,
        weights: [0.0, 0.9, 0.4, 0.0, 0.4, 0.9],
        colour: [0.062, 0.080, 0.032],
    },
    // Prostrate, 1-2 m tall and several wide, 1,600-3,900 m about the tree line of the Tian Shan: Farjon 2010 (J. pseudosabina).
    Species {
        name: "Juniperus pseudosabina",
        shape: Shape::Bush,
        height_m: [0.8, 2.4],
        width: 1.9,
        belt: [0.55, 1.25],
        latitudes_deg: [35.0, 52.0],
        dryness: DRY,
        steepest: 0.9,
        weights: [0.0, 0.0, 0.0, 1.0, 1.0, 0.0],
        colour: [0.064, 0.072, 0.042],
    },
    // Caragana, Rosa, Berberis and the like, hazel and thorn in Europe: 1-4 m.
    Species {
        name: "shrubs",
        shape: Shape::Bush,
        height_m: [1.0, 3.5],
        width: 1.1,
        belt: [0.0, 0.9],
        latitudes_deg: [0.0, 75.0],
        dryness: ALL_DRYNESS,
        steepest: 0.8,
        weights: [0.05, 0.10, 0.08, 1.0, 0.8, 0.5],
        colour: [0.086, 0.086, 0.044],
    },
    // Pinus halepensis 10-20 m and Quercus ilex 8-20 m, to about 1,000 m: European Atlas of Forest Tree Species, 2016.
    Species {
        name: "Pinus halepensis",
        shape: Shape::Pine,
        height_m: [7.0, 18.0],
        width: 0.65,
        belt: [0.0, 0.45],
        latitudes_deg: [0.0, 44.2],
        dryness: MOIST,
        steepest: 0.75,
        weights: [0.9, 0.5, 0.7, 0.1, 0.5, 0.5],
        colour: [0.052, 0.078, 0.036],
    },
];

/// What grows in a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flora {
    /// Height of the tree line on level ground, metres.
    pub tree_line_m: f32,
    /// [`Climate::dryness`].
    pub dryness: f32,
    /// Which species the latitude and the dryness let grow on each [`Site`]: a bit each.
    here: [u32; 6],
}

impl Site {
    /// Of a cover; `None` where nothing taller than grass grows.
    pub fn of(cover: CoverClass) -> Option<Self> {
        match cover {
            CoverClass::Conifer => Some(Self::Conifer),
            CoverClass::Broadleaf => Some(Self::Broadleaf),
            CoverClass::MixedForest => Some(Self::Mixed),
            CoverClass::Scrub => Some(Self::Scrub),
            CoverClass::Field | CoverClass::Grass => Some(Self::Open),
            CoverClass::BuiltUp => Some(Self::BuiltUp),
            _ => None,
        }
    }
}

impl Flora {
    /// Of a world's climate and latitude.
    pub fn new(climate: &Climate, latitude_rad: f64) -> Self {
        // Trees end about a quarter below the snow line of level ground (C. Troll 1962: 700 to 1,000 m below it).
        let latitude_deg = (latitude_rad.to_degrees().abs() as f32).min(90.0);
        let dryness = climate.dryness;
        let mut here = [0; 6];
        for (number, species) in SPECIES.iter().enumerate() {
            if within(species.latitudes_deg, latitude_deg) && within(species.dryness, dryness) {
                for (here, weight) in here.iter_mut().zip(species.weights) {
                    *here |= u32::from(weight > 0.0) << number;
                }
            }
        }
        Self { tree_line_m: (climate.snow_line_m * 0.77).max(200.0), dryness, here }
    }

    /// The species for a site, by a number in 0..1; `None` if none of them grows there.
    pub fn choose(&self, site: Site, height_m: f32, steep: f32, number: f32) -> Option<usize> {
        let belt = height_m / self.tree_line_m;
        let mut weights = [0.0; SPECIES.len()];
        let mut total = 0.0;
        for at in bits(self.here[site as usize]) {
            let species = &SPECIES[at];
            if within(species.belt, belt) && steep <= species.steepest {
                weights[at] = species.weights[site as usize];
                total += weights[at];
            }
        }
        let mut rest = number * total;
        let mut last = None;
        for at in bits(self.here[site as usize]).filter(|at| weights[*at] > 0.0) {
            last = Some(at);
            if rest < weights[at] {
                break;
            }
            rest -= weights[at];
        }
        last
    }
}

fn within(range: [f32; 2], value: f32) -> bool {
    (range[0]..=range[1]).contains(&value)
}

/// Numbers of the bits that are set, from the lowest.
fn bits(mut word: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let at = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (at < u32::BITS).then_some(at as usize)
    })
}

// A bit for each.
const _: () = assert!(SPECIES.len() <= 32);

#[cfg(test)]
mod tests {
    use super::*;

    fn flora(latitude_deg: f64, mean_m: f64) -> Flora {
        Flora::new(&Climate::new(latitude_deg.to_radians(), mean_m), latitude_deg.to_radians())
    }

    fn share(flora: &Flora, site: Site, height_m: f32, name: &str) -> f32 {
        let chosen = |at: i32| flora.choose(site, height_m, 0.3, at as f32 / 1_000.0);
        (0..1_000).filter(|at| chosen(*at).is_some_and(|s| SPECIES[s].name == name)).count() as f32 / 1_000.0
    }

    #[test]
    fn the_tian_shan_has_its_spruce_and_the_alps_have_theirs() {
        let inner_asia = flora(42.4, 2_400.0);
        assert!((2_700.0..3_200.0).contains(&inner_asia.tree_line_m), "{}", inner_asia.tree_line_m);
        assert!(share(&inner_asia, Site::Conifer, 2_400.0, "Picea schrenkiana") > 0.9);
        assert_eq!(share(&inner_asia, Site::Conifer, 2_400.0, "Picea abies"), 0.0);
        let alps = flora(47.0, 1_200.0);
        assert!(share(&alps, Site::Conifer, 1_400.0, "Picea abies") > 0.3);
        assert!(share(&alps, Site::Broadleaf, 600.0, "Fagus sylvatica") > 0.3);
    }

    #[test]
    fn nothing_grows_where_nothing_may() {
        let alps = flora(47.0, 1_200.0);
        assert_eq!(alps.choose(Site::Conifer, 9_000.0, 0.1, 0.5), None);
        assert_eq!(alps.choose(Site::Conifer, 900.0, 0.99, 0.5), None);
        assert_eq!(alps.choose(Site::Conifer, f32::NAN, 0.1, 0.5), None);
        assert_eq!(Site::of(CoverClass::Water), None);
    }

    #[test]
    fn figures_are_sane() {
        for species in SPECIES {
            assert!(species.height_m[0] > 0.0 && species.height_m[0] < species.height_m[1], "{}", species.name);
            assert!(species.colour.iter().all(|c| (0.005..0.2).contains(c)), "{}", species.name);
            assert!(species.weights.iter().any(|w| *w > 0.0), "{}", species.name);
        }
    }
}
