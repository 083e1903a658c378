//! `simulate` from outside: rows, report, exit status, and the ground of the embedded world.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/flight/");

/// The columns of `O.csv` before the controls, as they are fixed.
const HEADER: &str = "t_s,lat_deg,lon_deg,altitude_m,north_m,east_m,agl_m,vn_mps,ve_mps,vd_mps,u_mps,v_mps,w_mps,qw,qx,qy,qz,\
                      roll_deg,pitch_deg,yaw_deg,p_degps,q_degps,r_degps,p_local_degps,q_local_degps,r_local_degps,tas_mps,\
                      eas_mps,mach,alpha_deg,beta_deg,density_kgpm3,pressure_Pa,temperature_K,gravity_mps2,fx_N,fy_N,fz_N,\
                      mx_Nm,my_Nm,mz_Nm,nz_g";

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("simulate").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn simulate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poligon"));
    command.arg("simulate").args(arguments).current_dir(folder).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_flight_is_told_as_rows_as_json_or_as_a_file() {
    let folder = folder("told");
    let [model, case, inputs] =
        ["models/lin182.toml", "cases/lin182.toml", "inputs/lin182.csv"].map(|file| format!("{ASSETS}{file}"));
    let flight = ["--model", &model, "--case", &case, "--inputs", &inputs];
    let rows = simulate(&folder, &flight);
    assert_eq!((rows.status.code(), text(&rows.stderr).as_str()), (Some(0), ""));
    let rows = text(&rows.stdout);
    let mut lines = rows.lines();
    assert_eq!(lines.next(), Some(format!("{HEADER},elevator_rad,aileron_rad,rudder_rad,event").as_str()));
    let lines: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(lines.len(), 601, "60 s at 0.1 s, start and end included");
    for (i, cells) in lines.iter().enumerate() {
        assert_eq!(cells.len(), 46);
        let t_s: f64 = cells[0].parse().unwrap();
        assert!((t_s - 0.1 * i as f64).abs() < 1e-9);
        assert!(cells[..45].iter().all(|cell| cell.parse::<f64>().unwrap().is_finite()));
    }
    assert_eq!((lines[0][45], lines[1][45], lines[600][45]), ("start", "", "end"));
    // The pulse of one second begins at 1 s, is turned at 2 s and over at 3 s.
    let elevator = |row: usize| lines[row][42].parse::<f64>().unwrap();
    assert!(elevator(9) < elevator(10) && elevator(20) < elevator(9) && elevator(30) == elevator(0));

    let json = simulate(&folder, &[&flight[..], &["--json"]].concat());
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!((json["event"].as_str(), json["rows"].as_u64()), (Some("end"), Some(601)));
    assert_eq!(json["last"]["altitude_m"].as_f64().unwrap(), lines[600][3].parse::<f64>().unwrap());
    assert!(json["stiffness"]["lambda_h"].as_f64().unwrap() < json["stiffness"]["limit"].as_f64().unwrap());

    let told = simulate(&folder, &[&flight[..], &["--out", "a/flight.csv"]].concat());
    assert!(told.status.success() && text(&told.stdout).contains("stiffness.lambda_radps"));
    assert_eq!(std::fs::read_to_string(folder.join("a/flight.csv")).unwrap(), rows);
    assert!(!folder.join("a/flight.csv.part").exists());
}

#[test]
fn files_that_cannot_be_used_end_with_2_and_are_named() {
    let folder = folder("refused");
    let put = |name: &str, content: &str| std::fs::write(folder.join(name), content).unwrap();
    put("m.toml", &std::fs::read_to_string(format!("{ASSETS}models/lin182.toml")).unwrap());
    put("c.toml", &std::fs::read_to_string(format!("{ASSETS}cases/lin182.toml")).unwrap());
    put("nan.csv", "t_s,elevator_rad\n0,0.1\n1,nan\n");
    put("late.csv", "t_s,elevator_rad\n1,0.1\n0,0.1\n");
    put("key.toml", "[body]\nweight_kg = 3\n");
    put("step.toml", "[run]\nseconds = 1\n");
    put("stop.toml", "[run]\nseconds = 1\ndt_s = 0.01\nstop = [\"height<0\"]\n");
    put("shot.toml", "[run]\nseconds = 1\ndt_s = 0.01\n[shot]\nspeed_mps = 3\n");
    put("bytes.toml", "\u{0}\u{1}[[[[");
    for (model, case, inputs, told) in [
        ("m.toml", "c.toml", Some("nan.csv"), &["nan.csv", "line 3", "elevator_rad", "nan"][..]),
        ("m.toml", "c.toml", Some("late.csv"), &["late.csv", "line 3", "above 1"]),
        ("m.toml", "c.toml", Some("none.csv"), &["none.csv"]),
        ("key.toml", "c.toml", None, &["key.toml", "weight_kg"]),
        ("none.toml", "c.toml", None, &["none.toml"]),
        ("bytes.toml", "c.toml", None, &["bytes.toml"]),
        ("m.toml", "m.toml", None, &["m.toml", "unknown field"]),
        ("m.toml", "step.toml", None, &["step.toml", "run.dt_s"]),
        ("m.toml", "stop.toml", None, &["stop.toml", "height"]),
        ("m.toml", "shot.toml", None, &["shot.toml", "poligon trajectory"]),
    ] {
        let mut arguments = vec!["--model", model, "--case", case, "--out", "o.csv"];
        arguments.extend(inputs.map(|inputs| ["--inputs", inputs]).into_iter().flatten());
        let output = simulate(&folder, &arguments);
        let error = text(&output.stderr);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}: {error}");
        assert!(told.iter().all(|word| error.contains(word)), "{arguments:?}: {error}");
        assert!(!folder.join("o.csv").exists());
    }
}

#[test]
fn a_flight_ends_on_the_ground_that_height_gives() {
    let folder = folder("ground");
    let [model, case] = ["models/lin182.toml", "cases/into_the_range.toml"].map(|file| format!("{ASSETS}{file}"));
    let output = simulate(&folder, &["--model", &model, "--case", &case, "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let flown: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(flown["event"].as_str(), Some("stop: ground"));
    let last = |name: &str| flown["last"][name].as_f64().unwrap();
    std::fs::write(folder.join("p.csv"), format!("lat_deg,lon_deg\n{:?},{:?}\n", last("lat_deg"), last("lon_deg")))
        .unwrap();
    let mut height = Command::new(env!("CARGO_BIN_EXE_poligon"));
    let height = height.args(["height", "--points", "p.csv", "--json"]).current_dir(&folder).output().unwrap();
    let height: Value = serde_json::from_slice(&height.stdout).unwrap();
    let under = height["points"][0]["height_m"].as_f64().unwrap();
    // The cubic of a step of 1/120 s is nanometres off the flight; a map of 100 km to and fro as much.
    assert!((under - last("altitude_m")).abs() < 1e-6, "{under} {}", last("altitude_m"));
    assert!(last("agl_m").abs() < 1e-6);

    // A world that is named is there, whether or not a stop asks for its ground.
    let unasked = std::fs::read_to_string(&case).unwrap().replace("stop = [\"ground\"]\n", "");
    std::fs::write(folder.join("c.toml"), unasked).unwrap();
    let output = simulate(&folder, &["--model", &model, "--case", "c.toml", "--json"]);
    let same: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&same["event"], &same["time_s"]), (&flown["event"], &flown["time_s"]));
}

#[test]
fn nothing_that_is_read_is_written_over() {
    let folder = folder("over");
    let copy =
        |name: &str| std::fs::copy(format!("{ASSETS}{name}"), folder.join(name.rsplit('/').next().unwrap())).unwrap();
    copy("models/sphere.toml");
    copy("cases/drop.toml");
    for out in ["sphere.toml", "./drop.toml"] {
        let output = simulate(&folder, &["--model", "sphere.toml", "--case", "drop.toml", "--out", out]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains("which is read"), "{error}");
    }
    assert!(simulate(&folder, &["--model", "sphere.toml", "--case", "drop.toml", "--out", "o.csv"]).status.success());
}

#[test]
fn a_flight_that_fails_ends_with_1_and_keeps_its_rows() {
    let folder = folder("failed");
    let body = "[body]\nmass_kg = 1\ninertia_kgm2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n[reference]\narea_m2 = 1\n\
                [[aero.term]]\nto = \"CD\"\ntable = \"t\"\n[table.t]\naxes = [\"altitude_m\"]\nbreakpoints = [[90, 100]]\n\
                values = [0, 0]\noutside = \"error\"\n";
    std::fs::write(folder.join("m.toml"), body).unwrap();
    std::fs::write(
        folder.join("c.toml"),
        "[initial]\naltitude_m = 100\n[run]\nseconds = 9\ndt_s = 0.01\noutput_dt_s = 0.5\n",
    )
    .unwrap();
    let output = simulate(&folder, &["--model", "m.toml", "--case", "c.toml", "--out", "o.csv"]);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("table.t") && error.contains("altitude_m within 90 and 100"), "{error}");
    let rows = std::fs::read_to_string(folder.join("o.csv")).unwrap();
    assert!(rows.lines().count() > 3 && rows.trim_end().ends_with(",failed"), "{rows}");
}
