//! How machines and people call the columns of a joint: what is taken for granted, and what is asked.

use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use tauscope::experiment::{
    ColumnMap, Experiment, Failure, JointColumns, MemoryLimit, ReadErrorKind, ReadOptions, Survey,
};

/// Headers of the time, then an input and an output of each joint, then a pressure where there is one more;
/// and the joints that are found, with a `?` where the data had to help and a person is asked.
const HEADERS: [(&str, &str); 45] = [
    // Hydraulics.
    ("t_s,u_boom_pct,boom_deg", "boom"),
    ("t_s,boom_pct,boom_deg,stick_pct,stick_deg", "boom stick"),
    ("time,pwm_cmd_us,pwm_angle_deg", "angle"),
    ("t,valve_mA,valve_bar", "valve"),
    ("time,sol_lift_mA,cyl_lift_mm,sol_tilt_mA,cyl_tilt_mm,p_supply_bar", "lift tilt"),
    ("Timestamp,EEC_SwashCmd_mA,Motor_rpm", "motor"),
    ("t_s,pump_cmd_pct,pump_flow_lpm", "pump"),
    ("time,joy_boom,boom_deg,joy_arm,arm_deg", "boom arm"),
    ("t_s,spool_mm,rod_mm", "rod"),
    ("time,boom_valve,boom_angle,arm_valve,arm_angle,arm_pressure", "boom arm"),
    ("t_s,u_V,x_mm,pA_bar", "x?"),
    ("t,lift_cmd,lift_deg,lift_bar", "lift"),
    // Processes.
    ("Time,Q1,T1", "t1?"),
    ("Time,Q1,T1,Q2,T2", "t1? t2?"),
    ("t,h2,t2", "t2?"),
    ("Time,Heater 1 (%),Temperature 1 (degC)", "temperature"),
    ("Time,MV,PV", "pv"),
    ("time,LIC101.OP,LIC101.PV,FIC102.OP,FIC102.PV", "lic101 fic102"),
    ("timestamp,setpoint_rpm,actual_rpm", "actual"),
    // ROS and PlotJuggler.
    (
        "__time,/arm/roll/command,/arm/roll/position,/arm/pitch/command,/arm/pitch/position",
        "roll pitch",
    ),
    ("__time,/psm/roll/velocity,/psm/roll/position", "psm_roll?"),
    ("time,/valve_cmd/boom/data,/joint_states/boom/position,/joint_states/boom/effort", "boom"),
    ("__time,/cmd_vel/linear/x,/odom/twist/twist/linear/x", "linear"),
    ("%time,field.effort0,field.position0,field.effort1,field.position1", "position0? position1?"),
    ("time,ctrl[0],qpos[0],ctrl[1],qpos[1]", "qpos_0 qpos_1"),
    // PLC.
    ("Time,MAIN.rBoomCmd,MAIN.rBoomPos,MAIN.rArmCmd,MAIN.rArmPos", "boom arm"),
    ("Time,GVL.fValveBoom,GVL.fAngleBoom", "boom"),
    ("time,PLC_PRG.lift.AO_Valve,PLC_PRG.lift.AI_Pos", "lift"),
    ("Zeit,Achse1_Soll,Achse1_Ist,Achse2_Soll,Achse2_Ist", "achse1 achse2"),
    ("Zeit,Stellgröße,Istwert", "istwert"),
    (
        "Zeit [s],Ventil_Ausleger [%],Winkel_Ausleger [°],Ventil_Stiel [%],Winkel_Stiel [°]",
        "ausleger stiel",
    ),
    ("Zeit / s,Ventilstrom / mA,Zylinderweg / mm", "zylinderweg"),
    ("Zeit,Steuerspannung [V],Kolbenweg [mm],Druck [bar]", "kolbenweg"),
    // LabVIEW, Simulink, Excel.
    ("Time (s),AO0 - Valve (V),AI0 - Position (mm)", "ai0_position"),
    ("X_Value,Voltage_0 (Command),Voltage_1 (Position)", "position"),
    ("Time,dac0,adc0,dac1,adc1", "adc0 adc1"),
    ("t,u1,y1,u2,y2", "y1 y2"),
    ("time,In1,Out1", "out1"),
    ("time,Step:1,Plant:1", "plant?"),
    ("t,q1_des,q1,q2_des,q2", "q1 q2"),
    (
        "Time (s),Valve opening (%),Cylinder position (mm),Supply pressure (bar)",
        "cylinder_position",
    ),
    // Others.
    ("time,esc_us,rpm", "rpm"),
    ("time,joy_x,swing_deg,joy_y,boom_deg", "swing? boom?"),
    ("Time,AnalogOut_1,AnalogIn_1", "analog_1?"),
    ("t,a,b,c,d", "b? d?"),
];

const ROWS: usize = 2000;

/// A joint that follows levels of its own as a first order, 12 rows late.
fn joint(seed: usize) -> [Vec<f64>; 2] {
    let level = |k: usize| (k * (7 + 4 * seed) * 7919 % 13) as f64 - 6.0;
    let (mut input, mut output, mut state) = (Vec::new(), Vec::new(), 20.0);
    for row in 0..ROWS {
        let at = |row: usize| level(row / (83 + 30 * seed));
        state += 0.02 * (20.0 + 4.0 * at(row.saturating_sub(12)) - state);
        input.push(at(row));
        output.push(state + 0.01 * ((row * 7919 % 97) as f64 / 97.0));
    }
    [input, output]
}

fn log(header: &str) -> String {
    let names = header.split(',').count();
    let mut columns: Vec<Vec<f64>> = [joint(0), joint(1)].into_iter().flatten().collect();
    columns.truncate((names - 1) / 2 * 2);
    if names.is_multiple_of(2) {
        columns.push((0..ROWS).map(|row| 100.0 + (row * 104_729 % 89) as f64 / 89.0).collect());
    }
    let mut text = format!("{header}\n");
    for row in 0..ROWS {
        write!(text, "{:.2}", 0.01 * row as f64).unwrap();
        for column in &columns {
            write!(text, ",{:.3}", column[row]).unwrap();
        }
        text.push('\n');
    }
    text
}

#[test]
fn columns_are_paired_by_what_their_names_share_and_else_by_the_data() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let mut wrong = Vec::new();
    for (header, expected) in HEADERS {
        fs::write(&path, log(header)).unwrap();
        let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
        let read = Experiment::read(std::slice::from_ref(&path), &ReadOptions::default());
        let columns: Vec<&str> = header.split(',').collect();
        let names = expected.split(' ').map(|name| name.trim_end_matches('?'));
        let pairs = columns[1..].chunks_exact(2);
        let expected_joints: Vec<JointColumns> = names
            .zip(pairs)
            .map(|(name, pair)| JointColumns::new(name, pair[0], pair[1]))
            .collect();
        let is_asked = expected.contains('?');
        let has_none = |f: &Failure| matches!(f.error.kind, ReadErrorKind::NoJoints(_));
        let refused = read.failures.iter().any(has_none);
        if survey.map.joints != expected_joints || survey.is_sure == is_asked || refused != is_asked
        {
            let failures: Vec<String> = read.failures.iter().map(|f| f.error.to_string()).collect();
            let found = survey.map.joints;
            wrong.push(format!("{header}: {found:?}, sure {}, {failures:?}", survey.is_sure));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn of_several_outputs_that_follow_one_input_all_are_offered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let [input, output] = joint(0);
    let mut text = "Time,Q1,T1,T2\n".to_owned();
    for row in 0..ROWS {
        let other = 0.8 * output[row] + 3.0;
        writeln!(text, "{},{},{:.3},{other:.3}", row as f64 / 100.0, input[row], output[row])
            .unwrap();
    }
    fs::write(&path, text).unwrap();
    let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
    assert_eq!(survey.map.joints, [JointColumns::new("t1", "Q1", "T1")]);
    let other: Vec<_> = survey.alternatives.iter().flat_map(|map| &map.joints).collect();
    assert_eq!(other, [&JointColumns::new("t2", "Q1", "T2")]);
}

#[test]
fn of_several_inputs_of_a_joint_the_one_that_moves_it_is_not_guessed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let ([pump, _], [valve, angle]) = (joint(1), joint(0));
    let mut text = "t,boom_pump_cmd,boom_valve_cmd,boom_angle\n".to_owned();
    for row in 0..ROWS {
        let cells = [row as f64 / 100.0, pump[row], valve[row], angle[row]];
        writeln!(text, "{}", cells.map(|cell| format!("{cell:.3}")).join(",")).unwrap();
    }
    fs::write(&path, text).unwrap();
    let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
    let maps = std::iter::once(&survey.map).chain(&survey.alternatives);
    let valve = JointColumns::new("boom", "boom_valve_cmd", "boom_angle");
    assert!(!survey.is_sure && maps.flat_map(|map| &map.joints).any(|joint| *joint == valve));
}

#[test]
fn what_a_person_confirms_once_is_read_from_then_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, log("Time,Q1,T1")).unwrap();
    let run = |arguments: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tauscope"));
        program.args(arguments).current_dir(folder.path()).output().unwrap()
    };
    let refused = String::from_utf8(run(&["estimate", "log.csv"]).stderr).unwrap();
    assert!(refused.contains("`--time Time --joint 't1=Q1:T1'`"), "{refused}");
    assert!(run(&["columns", "log.csv", "-w"]).status.success());
    assert!(run(&["estimate", "log.csv"]).status.success());
}

#[test]
fn a_mapping_that_was_kept_beside_a_log_holds_for_those_of_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, log("t,a,b,c,d")).unwrap();
    let map =
        ColumnMap { joints: vec![JointColumns::new("boom", "a", "b")], ..ColumnMap::default() };
    let read = || Experiment::read(std::slice::from_ref(&path), &ReadOptions::default());
    // A file of another program is none.
    fs::write(folder.path().join("columns.toml"), "columns = ['a', 'b']").unwrap();
    assert!(read().joints.is_empty());
    fs::write(folder.path().join("columns.toml"), map.to_toml()).unwrap();
    let found = read();
    assert_eq!(found.joints[0].name, "boom");
    assert!(found.notes[0].contains("columns.toml"), "{:?}", found.notes);
    // One that cannot be read is said, where names say which columns are meant.
    fs::write(&path, log("t,boom_cmd,boom_pos")).unwrap();
    fs::write(folder.path().join("columns.toml"), "time = 't").unwrap();
    let found = read();
    assert_eq!(found.joints[0].name, "boom");
    let says = |note: &String| note.contains("the mapping beside it is not used");
    assert!(found.notes.iter().any(says), "{:?}", found.notes);
    // One for another log of the folder says nothing of this one.
    let map = ColumnMap { time: Some("t".to_owned()), ..map };
    fs::write(folder.path().join("columns.toml"), map.to_toml()).unwrap();
    let found = read();
    assert_eq!(found.joints[0].name, "boom");
    let says = |note: &String| note.contains("columns.toml` names the column `a`");
    assert!(found.notes.iter().any(says), "{:?}", found.notes);
    fs::write(&path, log("t,c,d,e,f")).unwrap();
    let error = read().failures[0].error.to_string();
    assert!(error.contains("columns.toml` names the column `a`"), "{error}");
    // What is named in the log itself stands above it.
    fs::write(&path, log("t,arm.input,arm.output")).unwrap();
    assert_eq!(read().joints[0].name, "arm");
}

#[test]
fn a_speed_that_is_measured_is_no_input_and_one_that_is_given_is() {
    let found = |late: usize, counts_per_deg: f64| {
        let speed = |row: usize| {
            let level = |row: usize| (row / 150 * 7919 % 13) as f64 - 6.0;
            // Its rise takes some rows, as that of any joint.
            (0..20).map(|k| level(row.saturating_sub(k)) / 20.0).sum::<f64>()
        };
        let mut position = 0.0;
        let mut text = "__time,/arm/roll/velocity,/arm/roll/position\n".to_owned();
        for row in 0..ROWS {
            position += 0.01 * speed(row.saturating_sub(late));
            let noise = 0.02 * ((row * 104_729 % 89) as f64 / 89.0 - 0.5);
            let read = ((position + noise) * counts_per_deg).round() / counts_per_deg;
            writeln!(text, "{:.2},{:.4},{read}", 0.01 * row as f64, speed(row)).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        fs::write(&path, text).unwrap();
        Survey::of(&path, MemoryLimit::default()).unwrap().map.joints.len()
    };
    for counts_per_deg in [1000.0, 10.0] {
        assert_eq!(found(0, counts_per_deg), 0, "measured, {counts_per_deg} counts per degree");
        assert_eq!(found(8, counts_per_deg), 1, "given, {counts_per_deg} counts per degree");
    }
}
