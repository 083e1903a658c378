//! DAVE-ML: NASA's models against their own check data, made-up documents, wrong documents, hostile bytes.
//!
//! NASA's files lie in `../shared`, outside the repository; without them a test says so and counts as skipped.

use proptest::prelude::*;
use sim::daveml::{DavemlError, Document, Kind};
use std::path::PathBuf;
use std::time::Instant;

const MODELS: &str = "../../shared/data/physics/nesc/NESC_data/All_models";
const F16: &str = "F16_package/F16_S119_source";

/// The text of one of NASA's models.
fn model(file: &str) -> Option<String> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(MODELS).join(file);
    std::fs::read_to_string(&path).inspect_err(|error| println!("skipped: {}: {error}", path.display())).ok()
}

fn document(body: &str) -> Result<Document, DavemlError> {
    Document::parse(&format!(
        "<?xml version=\"1.0\"?>\n<DAVEfunc xmlns=\"http://daveml.org/2010/DAVEML\">{body}</DAVEfunc>"
    ))
}

/// A document of inputs x, y and one output calculated by `math`.
fn calculation(math: &str) -> Result<Document, DavemlError> {
    document(&format!(
        "<variableDef name='ex' varID='x' units='nd'><isInput/></variableDef>\
         <variableDef name='why' varID='y' units='nd'><isInput/></variableDef>\
         <variableDef name='out' varID='z' units='nd'><calculation><math>{math}</math></calculation><isOutput/></variableDef>"
    ))
}

fn value(math: &str, x: f64, y: f64) -> f64 {
    let program = calculation(math).unwrap().program(&[], &["x", "y"], &["z"]).unwrap();
    let mut out = [0.0];
    program.run(&[x, y], &mut program.memory(), &mut out);
    // Folding must not change a bit.
    let folded = calculation(math).unwrap().program(&[("x", x), ("y", y)], &[], &["z"]).unwrap();
    let mut constant = [0.0];
    folded.run(&[], &mut folded.memory(), &mut constant);
    assert_eq!(out[0].to_bits(), constant[0].to_bits(), "{math}");
    assert_eq!(folded.operations(), 0);
    out[0]
}

fn check(file: &str, shots: usize) {
    let Some(text) = model(file) else { return };
    let checked = Document::parse(&text).unwrap().check().unwrap();
    assert_eq!(checked.len(), shots);
    let mut signals = 0;
    for shot in &checked {
        signals += shot.signals.len();
        for signal in shot.signals.iter().filter(|signal| !signal.passed()) {
            println!("{file} {:?} {signal:?}", shot.name);
        }
        assert!(shot.passed, "{file} {:?}", shot.name);
    }
    println!("{file}: {shots} of {shots} shots, {signals} signals");
}

#[test]
fn f16_aerodynamics_pass_their_16_shots() {
    check(&format!("{F16}/F16_aero.dml"), 16);
}

#[test]
fn f16_propulsion_passes_its_9_shots() {
    check(&format!("{F16}/F16_prop.dml"), 9);
}

/// Every model that is one (see below) compiles with all its inputs and all its outputs, and with inputs of 0 or their initial value no output
/// is NaN.
#[test]
fn every_model_runs() {
    let mut files: Vec<String> =
        ["aero", "prop", "inertia", "control", "gnc"].map(|part| format!("{F16}/F16_{part}.dml")).into();
    files.extend(["aero", "prop", "inertia"].map(|part| format!("two-stage_package/twostage_{part}.dml")));
    let plain = ["orbital_station", "orbital_cylinder", "cannonball", "brick"];
    files.extend(plain.map(|name| format!("{name}_inertia.dml")));
    files.extend(["cannonball", "brick"].map(|name| format!("{name}_aero.dml")));
    for file in files {
        let Some(text) = model(&file) else { return };
        let document = Document::parse(&text).unwrap_or_else(|error| panic!("{file}: {error}"));
        let inputs: Vec<_> = document.variables().iter().filter(|v| v.kind == Kind::Input).collect();
        let outputs: Vec<_> = document.variables().iter().filter(|v| v.is_output).collect();
        let by_name: Vec<_> = inputs.iter().map(|v| v.name.as_str()).collect();
        let by_id: Vec<_> = outputs.iter().map(|v| v.id.as_str()).collect();
        let program = document.program(&[], &by_name, &by_id).unwrap_or_else(|error| panic!("{file}: {error}"));
        let values: Vec<_> = inputs.iter().map(|v| v.initial.unwrap_or(0.0)).collect();
        let mut found = vec![0.0; outputs.len()];
        program.run(&values, &mut program.memory(), &mut found);
        println!("{file}: {} inputs, {} outputs, {} operations", inputs.len(), outputs.len(), program.operations());
        for (output, value) in outputs.iter().zip(&found) {
            assert!(value.is_finite(), "{file} {}: {value}", output.id);
        }
        for variable in document.variables() {
            let known = sim::daveml::si_factor(&variable.units).is_some();
            let at_border = variable.is_output || variable.kind == Kind::Input;
            assert!(known || !at_border, "{file} {}: units {:?}", variable.id, variable.units);
        }
    }
}

/// NASA's sphere gives its inertia as "(2/5)" and a Greek pi, where only a number may stand: refused, not guessed.
#[test]
fn an_initial_value_that_is_no_number_is_refused_where_it_stands() {
    let Some(text) = model("orbital_sphere_inertia.dml") else { return };
    let error = Document::parse(&text).unwrap_err();
    assert!(matches!(&error, DavemlError::Number { place, .. } if place.owner == "XIXX"), "{error}");
}

/// The control law's names differ in case from those of the propulsion; its limits and switches, by hand.
#[test]
fn f16_control_switches_and_limits() {
    let Some(text) = model(&format!("{F16}/F16_control.dml")) else { return };
    let document = Document::parse(&text).unwrap();
    assert_eq!(document.variable("altitudeMSL").unwrap().id, "altMsl");
    // Everything off and trims at 0: the throttle passes, limited as the input that it is.
    let off = [("sasOn", 0.0), ("apOn", 0.0), ("throttleTrim", 0.0)];
    let program = document.program(&off, &["pilotControl_throttle"], &["PWR"]).unwrap();
    let power = |throttle: f64| {
        let mut out = [f64::NAN];
        program.run(&[throttle], &mut program.memory(), &mut out);
        out[0]
    };
    assert_eq!([power(-1.0), power(0.3), power(1.0), power(2.0)], [0.0, 30.0, 100.0, 100.0]);
    // On, the same output needs the sensors.
    let on = document.program(&[("sasOn", 1.0), ("apOn", 0.0)], &["throttle"], &["PWR"]).unwrap_err();
    assert!(matches!(&on, DavemlError::NoValue { output, .. } if output == "PWR"), "{on}");
    let limited = document.program(&[("altCmd", 0.0)], &["altitudeMsl"], &["deltaThetaCmd"]).unwrap();
    let mut memory = limited.memory();
    for (altitude_ft, pitch_deg) in [(0.0, 0.0), (20.0, -1.0), (1e6, -5.0), (-1e6, 5.0)] {
        let mut out = [f64::NAN];
        limited.run(&[altitude_ft], &mut memory, &mut out);
        assert_eq!(out[0], pitch_deg, "{altitude_ft}");
    }
}

#[test]
fn every_function_of_mathml_is_computed() {
    let two = |name: &str| format!("<apply><{name}/><ci>x</ci><ci>y</ci></apply>");
    let one = |name: &str| format!("<apply><{name}/><ci>x</ci></apply>");
    let (x, y) = (0.3f64, -1.7f64);
    for (name, expected) in [
        ("plus", x + y),
        ("minus", x - y),
        ("times", x * y),
        ("divide", x / y),
        ("power", x.powf(y)),
        ("min", y),
        ("max", x),
        ("lt", 0.0),
        ("gt", 1.0),
        ("leq", 0.0),
        ("geq", 1.0),
        ("eq", 0.0),
        ("neq", 1.0),
        ("and", 1.0),
        ("or", 1.0),
    ] {
        assert_eq!(value(&two(name), x, y), expected, "{name}");
    }
    for (name, expected) in [
        ("minus", -x),
        ("abs", x),
        ("cos", x.cos()),
        ("sin", x.sin()),
        ("tan", x.tan()),
        ("arcsin", x.asin()),
        ("arccos", x.acos()),
        ("arctan", x.atan()),
        ("exp", x.exp()),
        ("ln", x.ln()),
        ("log", x.log10()),
        ("root", x.sqrt()),
        ("floor", 0.0),
        ("ceiling", 1.0),
        ("not", 0.0),
        ("plus", x),
        ("times", x),
        ("and", 1.0),
    ] {
        assert_eq!(value(&one(name), x, y), expected, "{name}");
    }
    for (math, expected) in [
        ("<apply><plus/></apply>", 0.0),
        ("<apply><plus/><ci>x</ci><ci>y</ci><cn>2.5</cn><cn> -1e1 </cn></apply>", x + y + 2.5 - 10.0),
        ("<apply><lt/><ci>y</ci><ci>x</ci><cn>1</cn></apply>", 1.0),
        ("<apply><lt/><ci>y</ci><ci>x</ci><cn>0</cn></apply>", 0.0),
        ("<apply><root/><degree><cn>4</cn></degree><ci>x</ci></apply>", x.powf(0.25)),
        ("<apply><log/><logbase><cn>2</cn></logbase><ci>x</ci></apply>", x.ln() / 2f64.ln()),
        ("<apply><power/><ci>y</ci><cn>2</cn></apply>", y * y),
        ("<apply><power/><ci>x</ci><cn>0.5</cn></apply>", x.sqrt()),
        ("<cn type='e-notation'>1.5<sep/>-3</cn>", 1.5e-3),
        (
            "<apply><csymbol definitionURL='http://any/f#atan2' encoding='text'>atan2</csymbol><ci>y</ci><ci>x</ci></apply>",
            y.atan2(x),
        ),
        ("<apply><csymbol>atan2</csymbol><ci>y</ci><ci>x</ci></apply>", y.atan2(x)),
        ("<apply><ci>y</ci></apply>", y),
        ("<apply><times/><cn>2</cn><pi/></apply>", std::f64::consts::TAU),
    ] {
        assert_eq!(value(math, x, y), expected, "{math}");
    }
    assert!(value(&two("min"), f64::MAX, -f64::MAX).is_finite());
}

#[test]
fn a_branch_not_taken_does_not_leak() {
    let math = "<apply><piecewise>\
        <piece><apply><ln/><ci>x</ci></apply><apply><gt/><ci>x</ci><cn>0</cn></apply></piece>\
        <piece><apply><divide/><cn>1</cn><ci>x</ci></apply><apply><lt/><ci>x</ci><cn>0</cn></apply></piece>\
        <otherwise><ci>y</ci></otherwise></piecewise></apply>";
    for (x, y, expected) in [(2.0, 7.0, 2f64.ln()), (-4.0, 7.0, -0.25), (0.0, 7.0, 7.0), (-0.0, 7.0, 7.0)] {
        assert_eq!(value(math, x, y), expected, "{x}");
    }
    // Undefined is NaN, not some number.
    let nowhere = "<piecewise><piece><ci>y</ci><apply><gt/><ci>x</ci><cn>0</cn></apply></piece></piecewise>";
    assert!(value(nowhere, -1.0, 3.0).is_nan());
}

const GLIDER: &str = "
  <variableDef name='angleOfAttack' varID='a' units='deg' minValue='-20' maxValue='20'><isInput/></variableDef>
  <variableDef name='mach' varID='m' units='nd' initialValue='0.5'><isInput/></variableDef>
  <variableDef name='gain' varID='k' units='nd' initialValue='2.0' maxValue='3.0'/>
  <variableDef name='lift' varID='cl' units='nd'><isOutput/></variableDef>
  <variableDef name='drag' varID='cd' units='nd'><isOutput/></variableDef>
  <variableDef name='steps' varID='st' units='nd'><isOutput/></variableDef>
  <variableDef name='double' varID='dl' units='ft' maxValue='5'><calculation><math>
    <apply><times/><ci>k</ci><ci>cl</ci></apply></math></calculation><isOutput/></variableDef>
  <breakpointDef name='angles' bpID='A' units='deg'><bpVals>-10, 0 <!-- zero -->10</bpVals></breakpointDef>
  <breakpointDef name='machs' bpID='M' units='nd'><bpVals>0.0 1.0</bpVals></breakpointDef>
  <griddedTableDef name='t' gtID='T'><breakpointRefs><bpRef bpID='M'/><bpRef bpID='A'/></breakpointRefs>
    <dataTable>-1, 0, 1, <!-- fast --> -2; 0 2</dataTable></griddedTableDef>
  <function name='f'><independentVarRef varID='m' extrapolate='neither'/>
    <independentVarRef varID='a' min='-10' max='12' extrapolate='max'/>
    <dependentVarRef varID='cl'/><functionDefn><griddedTableRef gtID='T'/></functionDefn></function>
  <function name='g'><independentVarPts varID='a'>-10 10</independentVarPts>
    <dependentVarPts varID='cd'>0 20</dependentVarPts></function>
  <function name='h'><independentVarRef varID='a' interpolate='discrete'/><dependentVarRef varID='st'/><functionDefn>
    <griddedTableDef><breakpointRefs><bpRef bpID='A'/></breakpointRefs><dataTable>1 2 3</dataTable></griddedTableDef>
    </functionDefn></function>
  <checkData><staticShot name='one'>
    <checkInputs><signal><signalName>ANGLEOFATTACK</signalName><signalUnits>rad</signalUnits>
      <signalValue>0.08726646259971647</signalValue></signal></checkInputs>
    <internalValues><signal><varID>k</varID><signalValue>2</signalValue></signal></internalValues>
    <checkOutputs><signal><signalName>lift</signalName><signalValue>0.75</signalValue><tol>1e-9</tol></signal>
      <signal><signalName>double</signalName><signalUnits>m</signalUnits><signalValue>0.4572</signalValue></signal>
    </checkOutputs></staticShot>
    <staticShot name='wrong'><checkInputs><signal><varID>a</varID><signalValue>99</signalValue></signal></checkInputs>
    <checkOutputs><signal><signalName>lift</signalName><signalValue>1.81</signalValue><tol>0.005</tol></signal>
    </checkOutputs></staticShot></checkData>";

#[test]
fn a_small_model_gives_what_a_hand_computes() {
    let glider = document(GLIDER).unwrap();
    let program = glider.program(&[], &["mach", "a"], &["lift", "drag", "st", "double", "gain", "a"]).unwrap();
    let mut memory = program.memory();
    let mut run = |mach: f64, angle: f64| {
        let mut out = [0.0; 6];
        program.run(&[mach, angle], &mut memory, &mut out);
        out
    };
    assert_eq!(run(0.0, 5.0), [0.5, 15.0, 3.0, 1.0, 2.0, 5.0]);
    assert_eq!(run(1.0, -5.0), [-1.0, 5.0, 2.0, -2.0, 2.0, -5.0]);
    // Mach is held at 1; the angle is extrapolated above, to 12, and held below; its own limits come first.
    assert_eq!(run(9.0, 99.0), [2.4, 20.0, 3.0, 4.8, 2.0, 20.0]);
    assert_eq!(run(9.0, -99.0), [-2.0, 0.0, 1.0, -4.0, 2.0, -20.0]);
    assert!(run(0.5, f64::NAN)[0].is_nan());
    assert_eq!(run(0.5, 0.0)[0], 0.0);
    // A constant and an input that are set; the constant's limit of 3 holds, and the output's of 5.
    let set = glider.program(&[("gain", 9.0), ("MACH", 1.0)], &["angleofattack"], &["double"]).unwrap();
    let mut out = [0.0];
    set.run(&[5.0], &mut set.memory(), &mut out);
    assert_eq!(out, [3.0]);
    set.run(&[10.0], &mut set.memory(), &mut out);
    assert_eq!(out, [5.0]);
}

#[test]
fn check_data_pass_and_fail_by_their_own_tolerance() {
    let shots = document(GLIDER).unwrap().check().unwrap();
    let passed: Vec<_> = shots.iter().map(|shot| (shot.name.as_str(), shot.passed, shot.signals.len())).collect();
    assert_eq!(passed, [("one", true, 3), ("wrong", false, 1)], "{shots:?}");
    // 99 degrees are limited to 20 as any input, then to 12.
    assert!((shots[1].signals[0].found - 1.8).abs() < 1e-12);
}

#[test]
fn what_is_asked_wrongly_is_named() {
    let glider = document(GLIDER).unwrap();
    let asked = |set: &[(&str, f64)], inputs: &[&str], outputs: &[&str]| {
        glider.program(set, inputs, outputs).unwrap_err().to_string()
    };
    assert_eq!(asked(&[], &[], &["flap"]), "as asked: there is no variable \"flap\"");
    assert_eq!(asked(&[], &["m"], &["double"]), "dl depends on a, which is not given and has no initial value");
    assert_eq!(asked(&[("cl", 1.0)], &["a"], &["double"]), "cl is calculated: expected an input or a constant");
    assert_eq!(asked(&[("k", f64::NAN)], &["a"], &["double"]), "k: expected a finite number, found NaN");
    assert_eq!(asked(&[], &["a", "angleOfAttack"], &["double"]), "as asked: a second input \"a\"");
    assert_eq!(asked(&[("a", 1.0)], &["a"], &["double"]), "as asked: a second setting \"a\"");
    // What no asked output depends on may lack.
    assert!(glider.program(&[], &[], &["gain"]).is_ok());
    let twins = document(
        "<variableDef name='Mass' varID='p' initialValue='1'/><variableDef name='mASS' varID='q' initialValue='2'/>",
    );
    let twins = twins.unwrap();
    assert_eq!(twins.variable("mass").unwrap_err().to_string(), "\"mass\" fits several variables: p, q");
    assert_eq!(twins.variable("Mass").unwrap().id, "p");
}

#[test]
fn wrong_documents_say_what_and_where() {
    let wrong = |body: &str| document(body).unwrap_err().to_string();
    let with = |from: &str, to: &str| {
        assert!(GLIDER.contains(from), "{from}");
        wrong(&GLIDER.replacen(from, to, 1))
    };
    assert_eq!(with("<ci>k</ci>", "<ci>kk</ci>"), "line 10, dl: there is no variable \"kk\"");
    assert_eq!(with("<times/>", "<curl/>"), "line 10, dl: <curl> is not supported");
    assert_eq!(with("<ci>k</ci>", "<ci>dl</ci>"), "variables depend on one another in a circle: dl");
    assert_eq!(with("gtID='T'/>", "gtID='U'/>"), "line 17, f: there is no table \"U\"");
    assert_eq!(with("<bpRef bpID='M'/>", "<bpRef bpID='N'/>"), "line 13, T: there is no breakpoints \"N\"");
    assert_eq!(with("-2; 0 2", "-2; 0"), "line 13, T: expected 6 values, one a node, found 5");
    assert_eq!(with("-2; 0 2", "-2; 0 inf"), "line 14, T: expected a finite number, found \"inf\"");
    assert_eq!(with("0.0 1.0", "1.0 1.0"), "line 13, T: axis 0: breakpoint 1 must be above 1, the one before, found 1");
    assert_eq!(with("varID='m' units", "varID='a' units"), "line 4: a second variable \"a\"");
    assert_eq!(with("varID='cd'>0", "varID='dl'>0"), "line 18: a second definition of variable \"dl\"");
    assert_eq!(with("'discrete'", "'cubicSpline'"), "line 20, h: interpolate \"cubicSpline\" is not supported");
    assert_eq!(with("maxValue='20'", "maxValue='-30'"), "line 3, a: expected minValue -20 not above maxValue -30");
    assert_eq!(with("<isInput/>", "<isInputt/>"), "line 3, a: <isInputt> is not supported");
    assert_eq!(
        wrong(&["a", "b", "c"].iter().zip(["b", "c", "a"]).map(|(id, of)| format!("<variableDef name='{id}' varID='{id}'><calculation><math><apply><sin/><ci>{of}</ci></apply></math></calculation></variableDef>")).collect::<String>()),
        "variables depend on one another in a circle: a -> b -> c"
    );
    let units = document(&GLIDER.replacen("<signalUnits>rad<", "<signalUnits>kg<", 1)).unwrap().check().unwrap_err();
    assert!(matches!(&units, DavemlError::Units { signal, .. } if signal == "kg"), "{units}");
}

#[test]
fn hostile_documents_are_refused_in_bounded_time() {
    let started = Instant::now();
    let nested = |open: &str, close: &str, times: usize| open.repeat(times) + "<cn>1</cn>" + &close.repeat(times);
    for times in [150, 250, 100_000] {
        let deep = calculation(&nested("<apply><abs/>", "</apply>", times));
        assert_eq!(deep.is_err(), times > 150, "{times}");
        assert!(times == 150 || matches!(deep, Err(DavemlError::Depth { .. })), "{:?}", deep.err());
        // Comparisons of comparisons must not double at each level.
        let chain = calculation(&nested("<apply><lt/><ci>x</ci>", "<ci>y</ci></apply>", times));
        assert_eq!(chain.is_err(), times > 150);
        assert!(times == 150 || document(&nested("<description>", "</description>", times)).is_err());
    }
    // Wide and deep at once: the depth of a tree is not the product.
    let wide = format!("<apply><plus/>{}", "<ci>x</ci>".repeat(1_000));
    assert!(value(&nested(&wide, "</apply>", 100), 1.0, 1.0) == 100_001.0);
    // A long chain of variables is no deep recursion.
    let chain: String = (0..50_000)
        .map(|n| format!("<variableDef name='v{n}' varID='v{n}'><calculation><math><ci>v{}</ci></math></calculation></variableDef>", n + 1))
        .collect();
    let end = "<variableDef name='e' varID='v50000' initialValue='7'/>";
    let program = document(&(chain.clone() + end)).unwrap().program(&[], &[], &["v0"]).unwrap();
    let mut out = [0.0];
    program.run(&[], &mut program.memory(), &mut out);
    assert_eq!(out, [7.0]);
    let ring = document(
        &(chain
            + "<variableDef name='e' varID='v50000'><calculation><math><ci>v0</ci></math></calculation></variableDef>"),
    );
    assert!(matches!(ring, Err(DavemlError::Cycle(ids)) if ids.len() == 50_001));
    let bomb = "<!DOCTYPE d [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><DAVEfunc>&b;</DAVEfunc>";
    assert!(matches!(Document::parse(bomb), Err(DavemlError::Xml(_))));
    let attributes: String = (0..200_000).map(|n| format!(" a{n}=''")).collect();
    assert!(matches!(Document::parse(&format!("<DAVEfunc{attributes}/>")), Err(DavemlError::Xml(_))));
    let spaces: String = (0..30_000).map(|n| format!("<description xmlns:n{n}='u'/>")).collect();
    assert!(matches!(document(&spaces), Err(DavemlError::Xml(_))));
    // Places of many signals are not each counted from the start of the text.
    let signal = "<signal><varID>v</varID><signalValue>1</signalValue></signal>\n".repeat(100_000);
    let many = "<variableDef name='v' varID='v' initialValue='1'/><checkData><staticShot><checkOutputs>".to_string()
        + &signal
        + "</checkOutputs></staticShot></checkData>";
    assert!(document(&many).unwrap().check().unwrap()[0].passed);
    for text in ["", "<", "<DAVEfunc", "<DAVEfunc>", "<other/>", "\u{0}", "<DAVEfunc><variableDef/></DAVEfunc>"] {
        assert!(Document::parse(text).is_err(), "{text}");
    }
    println!("hostile documents: {:.2} s", started.elapsed().as_secs_f64());
}

proptest! {
    // A failure prints its case; no file of them is kept beside the test.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is cut out of, put into or changed in a document, reading and checking it gives a result or an error.
    #[test]
    fn damaged_documents_never_panic(at in any::<prop::sample::Index>(), cut in 0usize..200, put in "[<>/a-zA-Z0-9 ='\"&;.!-]{0,12}") {
        let whole = format!("<DAVEfunc>{GLIDER}</DAVEfunc>");
        let from = at.index(whole.len());
        let to = (from + cut).min(whole.len());
        let damaged = format!("{}{put}{}", &whole[..from], &whole[to..]);
        if let Ok(document) = Document::parse(&damaged) {
            let _ = document.check();
            let outputs: Vec<_> = document.variables().iter().map(|v| v.id.as_str()).collect();
            let inputs: Vec<_> = document.variables().iter().filter(|v| v.kind == Kind::Input).map(|v| v.id.as_str()).collect();
            if let Ok(program) = document.program(&[], &inputs, &outputs) {
                program.run(&vec![1e300; inputs.len()], &mut program.memory(), &mut vec![0.0; outputs.len()]);
            }
        }
    }

    #[test]
    fn any_text_is_a_document_or_an_error(text in "\\PC{0,200}") {
        let _ = Document::parse(&text);
        let _ = document(&text);
        let _ = sim::daveml::si_factor(&text);
    }
}
