//! The command line: every verb, flag and default, as data.
//!
//! How a value is read and what it may be stands in [`crate::values`]. A flag that is not given is `None` where the
//! quality preset or the world decides. Misuse is told by clap and ends with exit status 2.

use crate::stage::cameras::Camera;
use crate::values::{
    self, CraterMark, Extent, Look, MapPoint, Overlay, Place, Priced, Quality, Size, Subject, Without,
};
use clap::{Args, Parser, Subcommand};
use sim::UtcTime;
use std::path::PathBuf;

/// Fly over real ground, and prove what you fly over.
#[derive(Debug, Parser)]
#[command(name = "poligon", version, max_term_width = 120, propagate_version = false)]
#[command(after_help = "A world W is a `.world` folder made by `poligon bake`. Without one the embedded Issyk-Kul \
                        world is taken.\nLogs go to stderr. Exit status: 0 done, 1 failed, 2 misuse.")]
pub struct CommandLine {
    /// Print one JSON object on stdout and nothing else.
    #[arg(long, global = true)]
    pub json: bool,
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Fly: in a window where there is a display, else headless with pictures.
    Fly(FlyArgs),
    /// Make a world out of elevation data.
    Bake(BakeArgs),
    /// Say what a world is.
    Info(InfoArgs),
    /// Prove a world: no cracks, the near picture is the ground, the far error, what a switch of level shows.
    Verify(VerifyArgs),
    /// Height, normal and surface of the ground at points of a CSV file.
    Height(HeightArgs),
    /// Whether two points see each other.
    Sight(SightArgs),
    /// Fly a body from files and write its flight as CSV.
    Simulate(SimulateArgs),
    /// Fly a shell or a bomb, as CSV.
    Trajectory(TrajectoryArgs),
    /// Measure how a model flies: its modes beside MIL-F-8785C, its figures beside its handbook.
    Modes(ModesArgs),
    /// Take one picture.
    Shot(ShotArgs),
    /// Take many pictures from a list, and a contact sheet of them.
    Gallery(GalleryArgs),
    /// Show what the sticks of this machine say, and write a file that binds them.
    Input(InputArgs),
    /// Measure speed beside a yardstick in the same run.
    Bench(BenchArgs),
    /// Measure accuracy against cost for every setting.
    Trade(TradeArgs),
}

/// How a picture is made; the same for `fly` and `shot`.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "View")]
pub struct ViewArgs {
    /// Size in pixels.
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "1280x720")]
    pub size: Size,
    /// Vertical field of view, degrees.
    #[arg(long, value_name = "F", value_parser = values::fov_y_deg, default_value = "60", allow_hyphen_values = true)]
    pub fov_y_deg: f64,
    /// Date and time, such as 2026-06-21T09:30:00Z or 2026-06-21T15:30+06:00 [default: the world's].
    #[arg(long, value_name = "ISO", value_parser = UtcTime::parse)]
    pub time: Option<UtcTime>,
    /// How far one sees, 100 to 1,000,000 metres; no farther than the window reaches.
    #[arg(long, value_name = "V", value_parser = values::visibility_m, allow_hyphen_values = true)]
    pub visibility_m: Option<f64>,
    /// Blocks along a side of the far ring: 12 or 24 [default: the preset's].
    #[arg(long, value_name = "N", value_parser = values::window)]
    pub window: Option<u32>,
    /// Draw every block at level 0: the yardstick for speed and looks.
    #[arg(long)]
    pub all_level_0: bool,
    /// Settings that belong together [default: what fits the adapter].
    #[arg(long, value_name = "P")]
    pub quality: Option<Quality>,
    /// Pixels drawn for a pixel shown, along a side, 0.25 to 1 [default: the preset's].
    #[arg(long, value_name = "S", value_parser = values::render_scale, allow_hyphen_values = true)]
    pub render_scale: Option<f64>,
    /// Samples a pixel: 1 or 4 [default: the preset's].
    #[arg(long, value_name = "N", value_parser = values::msaa)]
    pub msaa: Option<u32>,
    /// Show how the ground is made.
    #[arg(long, value_name = "O")]
    pub overlay: Option<Overlay>,
    /// Leave out what stands on the ground: overlays, objects, plants, lights.
    #[arg(long, value_name = "KIND", value_delimiter = ',', num_args = 1..)]
    pub without: Vec<Without>,
    /// Share of the plants that are drawn, 0 to 1 [default: the preset's].
    #[arg(long, value_name = "SHARE", value_parser = values::share, allow_hyphen_values = true)]
    pub plants: Option<f64>,
}

/// `poligon fly`
#[derive(Debug, Args)]
pub struct FlyArgs {
    /// The world [default: the embedded one].
    #[arg(long, value_name = "W")]
    pub world: Option<PathBuf>,
    /// Fly a situation: circuit, valley or range (on the embedded world), or a file of one. Headless its script flies.
    #[arg(long, value_name = "S", conflicts_with_all = ["eye", "heading_deg", "speed_mps"])]
    pub scenario: Option<PathBuf>,
    /// Open no window: fly the built-in track and take pictures.
    #[arg(long)]
    pub headless: bool,
    /// Wait for every block; the same input gives the same hashes. Headless.
    #[arg(long, conflicts_with = "paced_hz")]
    pub lockstep: bool,
    /// Never wait, like a window: frame times, late blocks and holes are counted. Headless.
    #[arg(long = "paced", value_name = "HZ", value_parser = values::pace_hz, allow_hyphen_values = true)]
    pub paced_hz: Option<f64>,
    /// How long to fly, seconds.
    #[arg(long = "seconds", value_name = "T", value_parser = values::seconds, allow_hyphen_values = true, conflicts_with = "frames")]
    pub seconds_s: Option<f64>,
    /// How long to fly, frames.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub frames: Option<u64>,
    /// Where to begin: degrees, and metres above mean sea level or, with `:agl`, above the ground.
    #[arg(long, value_name = "LAT,LON,ALT[:agl]", value_parser = values::place, allow_hyphen_values = true)]
    pub eye: Option<Place>,
    /// Where to fly: degrees clockwise from true north.
    #[arg(long = "heading", value_name = "DEG", value_parser = values::heading_deg, allow_hyphen_values = true)]
    pub heading_deg: Option<f64>,
    /// How fast, metres a second.
    #[arg(long, value_name = "V", value_parser = values::speed_mps, allow_hyphen_values = true)]
    pub speed_mps: Option<f64>,
    /// What the pilot flies: `point_mass`, which always flies well; `trainer`, a light aircraft with an engine, wheels and a
    /// stall; `jet`, a fighter by NASA's wind tunnel tables; `hover`, a light helicopter, simplified; or a body's M.toml with
    /// their names of controls. A body is trimmed where the track begins.
    #[arg(long, value_name = "A", default_value = "point_mass")]
    pub aircraft: String,
    /// Play these inputs (I.csv), as --record writes them, in the place of a pilot's.
    #[arg(long, value_name = "FILE")]
    pub inputs: Option<PathBuf>,
    /// Write the pilot's inputs to this file (I.csv) at the end.
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Bindings of sticks, as `poligon input --write` makes them [default: the pilot's own, if there are any].
    #[arg(long, value_name = "FILE")]
    pub sticks: Option<PathBuf>,
    /// Where the flight is seen from.
    #[arg(long, value_name = "C", value_enum, default_value = "cockpit")]
    pub camera: Camera,
    /// How the picture is made.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Folder for pictures: the contact sheet of a headless flight, the screenshots of a flown one.
    #[arg(long, value_name = "DIR", default_value = "poligon-pictures")]
    pub shots: PathBuf,
    /// Also write the report, as JSON, to this file.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

/// `poligon input`
#[derive(Debug, Args)]
pub struct InputArgs {
    /// Bindings of sticks; with --write, the file to write [default: poligon/sticks.toml in the folder for settings].
    #[arg(long, value_name = "FILE")]
    pub sticks: Option<PathBuf>,
    /// Ask for one control after the other and write the file that binds them.
    #[arg(long)]
    pub write: bool,
    /// How long to listen, seconds; with --write, at most for each control [default: 15, or 10].
    #[arg(long = "seconds", value_name = "T", value_parser = values::seconds, allow_hyphen_values = true)]
    pub seconds_s: Option<f64>,
}

/// `poligon bake`
#[derive(Debug, Args)]
pub struct BakeArgs {
    /// Elevation files: GeoTIFF, .hgt, .hgt.zip, .dem, .dem.gz, 16-bit PNG with a world file. Where they overlap the
    /// finest counts. `FILE@0.1` multiplies the file's heights, here decimetres, to make them metres.
    #[arg(long, value_name = "FILE", required = true, num_args = 1..)]
    pub dem: Vec<PathBuf>,
    /// Files of features: OpenStreetMap (.osm.pbf, .osm, .osm.gz), GeoJSON, shapefiles, tables of airfields (.csv), in a
    /// gzip or not; told apart by content. A lake's ground is set to its level (`level_m`), or to the middle height inside
    /// the outline; an airfield's to its elevation.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub features: Vec<PathBuf>,
    /// Photographs of the ground: GeoTIFF with red, green, blue, or PNG or JPEG with a world file in degrees. Where their
    /// pixels are as fine as the ground map (some 140 m at a step of 200 m) they replace its colours, else they tint them.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub imagery: Vec<PathBuf>,
    /// Distance between posts, metres (25..=400).
    #[arg(long = "step", value_name = "M", value_parser = values::step_m, default_value = "200", allow_hyphen_values = true)]
    pub step_m: f64,
    /// The world's centre, degrees [default: the middle of the data].
    #[arg(long, value_name = "LAT,LON", value_parser = values::map_point, allow_hyphen_values = true)]
    pub centre: Option<MapPoint>,
    /// The world's size, kilometres, rounded outward to whole blocks [default: that of the data, at most 400x400].
    #[arg(long, value_name = "WxH", value_parser = values::extent)]
    pub size_km: Option<Extent>,
    /// The folder to make, NAME.world; a world that is there is replaced, anything else is left alone.
    #[arg(long, value_name = "NAME.world")]
    pub out: PathBuf,
}

/// `poligon info`
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
}

/// `poligon verify`
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
}

/// `poligon height`
#[derive(Debug, Args)]
pub struct HeightArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
    /// The points: a CSV file whose first line is `lat_deg,lon_deg` (degrees) or `x_m,z_m` (metres east and south of the
    /// world's centre).
    #[arg(long, value_name = "FILE.csv")]
    pub points: PathBuf,
}

/// `poligon sight`
#[derive(Debug, Args)]
#[command(
    after_help = "The world is flat here, as in the picture: the Earth's curvature and refraction are left out. \
                        Ground that is\nnot in the world hides nothing. Exit status 0 whether they see each other or not."
)]
pub struct SightArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
    /// One end: degrees, and metres above mean sea level or, with `:agl`, above the ground.
    #[arg(long, value_name = "LAT,LON,ALT[:agl]", value_parser = values::place, allow_hyphen_values = true)]
    pub from: Place,
    /// The other end.
    #[arg(long, value_name = "LAT,LON,ALT[:agl]", value_parser = values::place, allow_hyphen_values = true)]
    pub to: Place,
}

/// `poligon simulate`
#[derive(Debug, Args)]
#[command(
    after_help = "docs/files.md describes the files. Without --out and --json the rows go to stdout. A file that cannot \
                        be used ends\nwith exit status 2, a flight that fails with 1; its rows up to there are written.\n\n\
                        Example, in assets/flight:\n  poligon simulate --model models/lin182.toml --case cases/lin182.toml \
                        --inputs inputs/lin182.csv --out /tmp/o.csv\n\nThe least that flies, M.toml and C.toml:\n  \
                        [body]\n  mass_kg = 5\n  inertia_kgm2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n\n  \
                        [initial]\n  altitude_m = 1000\n  [run]\n  seconds = 10\n  dt_s = 0.01"
)]
pub struct SimulateArgs {
    /// The body: masses, controls, coefficients, thrusts, DAVE-ML files.
    #[arg(long, value_name = "M.toml")]
    pub model: PathBuf,
    /// What surrounds it: the Earth, the air, where it starts, how it is stepped.
    #[arg(long, value_name = "C.toml")]
    pub case: PathBuf,
    /// What the controls do, over time.
    #[arg(long, value_name = "I.csv")]
    pub inputs: Option<PathBuf>,
    /// The rows, as CSV.
    #[arg(long, value_name = "O.csv")]
    pub out: Option<PathBuf>,
}

/// `poligon modes`
#[derive(Debug, Args)]
#[command(
    after_help = "The model needs controls elevator, aileron, rudder and throttle with their units; a [handbook] is \
                        compared if it has one. Where a mode or\nfigure is outside its limit the exit status is 1.\n\n\
                        Example:\n  poligon modes --model assets/aircraft/trainer.toml"
)]
pub struct ModesArgs {
    /// The body.
    #[arg(long, value_name = "M.toml")]
    pub model: PathBuf,
    /// Altitude of the flight that its modes are measured in, metres.
    #[arg(long, value_name = "M", default_value = "1500", allow_hyphen_values = true)]
    pub altitude_m: f64,
    /// Its speed, metres a second [default: 0.7 of the never-exceed speed].
    #[arg(long, value_name = "V", value_parser = values::speed_mps, allow_hyphen_values = true)]
    pub speed_mps: Option<f64>,
    /// Folder for a plot of each test, modes.svg and modes.png.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,
}

/// `poligon trajectory`
#[derive(Debug, Args)]
#[command(
    after_help = "docs/files.md describes the files. Without --out and --json the rows go to stdout. A file that cannot \
                        be used ends\nwith exit status 2.\n\nExample, in assets/ballistics:\n  poligon trajectory \
                        --projectile projectiles/308_175gr.toml --case cases/rifle_1000m.toml\n\nThe least that \
                        flies, P.toml and C.toml:\n  mass_kg = 0.01134\n  drag = \"G7\"\n  bc_lbpin2 = 0.243\n\n  \
                        [shot]\n  speed_mps = 800\n  elevation_deg = 1"
)]
pub struct TrajectoryArgs {
    /// What flies: mass, drag, spin, motor.
    #[arg(long, value_name = "P.toml")]
    pub projectile: PathBuf,
    /// From where, how, through what air, over what Earth, until when.
    #[arg(long, value_name = "C.toml")]
    pub case: PathBuf,
    /// Write the rows to this file.
    #[arg(long, value_name = "O.csv")]
    pub out: Option<PathBuf>,
}

/// `poligon shot`
#[derive(Debug, Args)]
pub struct ShotArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
    /// From where: degrees, and metres above mean sea level or, with `:agl`, above the ground.
    #[arg(long, value_name = "LAT,LON,ALT[:agl]", value_parser = values::place, allow_hyphen_values = true)]
    pub eye: Place,
    /// To where: degrees clockwise from true north, degrees above the horizon.
    #[arg(long, value_name = "AZ,EL", value_parser = values::look, allow_hyphen_values = true)]
    pub look: Look,
    /// The picture to write.
    #[arg(long, value_name = "PNG")]
    pub out: PathBuf,
    /// Draw the edges of the triangles.
    #[arg(long)]
    pub wireframe: bool,
    /// A crater in the ground: degrees, metres to the crest of its rim, metres of depth [default: 0.32 of the radius]. May be
    /// given several times.
    #[arg(long = "crater", value_name = "LAT,LON,RADIUS_M[,DEPTH_M]", value_parser = values::crater, allow_hyphen_values = true)]
    pub craters: Vec<CraterMark>,
    /// How the picture is made.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// `poligon gallery`
#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// The world [default: the embedded one].
    #[arg(value_name = "W")]
    pub world: Option<PathBuf>,
    /// The list of pictures, TOML [default: the embedded world's]. assets/gallery has examples.
    #[arg(long, value_name = "FILE.toml")]
    pub list: Option<PathBuf>,
    /// Folder for the pictures and contact-sheet.png.
    #[arg(long, value_name = "DIR", default_value = "poligon-gallery")]
    pub out: PathBuf,
    /// A crater in the ground: degrees, metres to the crest of its rim, metres of depth [default: 0.32 of the radius]. May be
    /// given several times.
    #[arg(long = "crater", value_name = "LAT,LON,RADIUS_M[,DEPTH_M]", value_parser = values::crater, allow_hyphen_values = true)]
    pub craters: Vec<CraterMark>,
    /// How the pictures are made.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// `poligon bench`
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// What to measure.
    #[arg(value_name = "SUBJECT", default_value = "all")]
    pub subject: Subject,
    /// The world to measure over [default: the embedded one].
    #[arg(long, value_name = "W")]
    pub world: Option<PathBuf>,
}

/// `poligon trade`
#[derive(Debug, Args)]
pub struct TradeArgs {
    /// Whose settings to measure.
    #[arg(value_name = "SUBJECT", default_value = "all")]
    pub subject: Priced,
    /// Fewer points and rounds; under 3 minutes.
    #[arg(long)]
    pub quick: bool,
    /// Folder for the table as CSV and JSON and the plots.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use clap::error::ErrorKind;

    fn read(line: &str) -> Result<CommandLine, clap::Error> {
        CommandLine::try_parse_from(std::iter::once("poligon").chain(line.split_whitespace()))
    }

    fn refused(line: &str) -> ErrorKind {
        read(line).err().unwrap_or_else(|| panic!("`{line}` was taken")).kind()
    }

    #[test]
    fn the_command_line_is_consistent() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn fly_reads_every_flag() {
        let line = "fly --world a.world --headless --paced 60 --frames 5000 --eye -42.5,77,1000:agl --heading -30 \
                    --speed-mps 300 --size 640x480 --fov-y-deg 50 --time 2026-06-21T09:30Z --visibility-m 50000 --window 12 \
                    --all-level-0 --quality software --render-scale 0.67 --msaa 4 --overlay blocks --shots d --report r.json --json";
        let line = read(line).unwrap();
        assert!(line.json);
        let Verb::Fly(fly) = line.verb else { panic!("not fly") };
        assert_eq!(
            (fly.paced_hz, fly.frames, fly.heading_deg, fly.speed_mps),
            (Some(60.0), Some(5000), Some(-30.0), Some(300.0))
        );
        assert_eq!(fly.eye.map(|eye| eye.lat_deg), Some(-42.5));
        assert_eq!((fly.view.window, fly.view.msaa, fly.view.render_scale), (Some(12), Some(4), Some(0.67)));
        assert_eq!((fly.view.quality, fly.view.overlay), (Some(Quality::Software), Some(Overlay::Blocks)));
        assert!(fly.view.all_level_0 && fly.headless && !fly.lockstep);
    }

    #[test]
    fn nothing_given_means_the_defaults() {
        let Verb::Fly(fly) = read("fly").unwrap().verb else { panic!("not fly") };
        assert_eq!((fly.view.size.to_string().as_str(), fly.view.fov_y_deg), ("1280x720", 60.0));
        assert!(fly.world.is_none() && fly.view.window.is_none() && fly.view.quality.is_none());
        let Verb::Bench(bench) = read("bench").unwrap().verb else { panic!("not bench") };
        assert_eq!(bench.subject, Subject::All);
        let Verb::Bake(bake) = read("bake --dem a.tif b.hgt.zip --out c.world").unwrap().verb else {
            panic!("not bake")
        };
        assert_eq!((bake.dem.len(), bake.step_m), (2, 200.0));
    }

    #[test]
    fn contradictions_and_gaps_are_refused() {
        assert_eq!(refused("fly --lockstep --paced 60"), ErrorKind::ArgumentConflict);
        assert_eq!(refused("fly --seconds 5 --frames 5"), ErrorKind::ArgumentConflict);
        assert_eq!(refused("bake --dem a.tif"), ErrorKind::MissingRequiredArgument);
        assert_eq!(refused("shot --eye 1,2,3 --out a.png"), ErrorKind::MissingRequiredArgument);
        assert_eq!(refused("fly --eye 91,0,0"), ErrorKind::ValueValidation);
        assert_eq!(refused("fly --frames 0"), ErrorKind::ValueValidation);
        assert_eq!(refused("fly --quality best"), ErrorKind::InvalidValue);
        for verb in ["scenario", "instructor", "replay", "serve"] {
            assert_eq!(refused(verb), ErrorKind::InvalidSubcommand);
        }
    }
}
