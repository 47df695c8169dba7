//! Protection of files: outputs that are inputs or each other, files of other programs, temporary files that a kill
//! leaves.

use std::fs;

use crate::runner::{Bench, assert_contains, data, short_log};

fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("log.csv", &short_log());
    fs::create_dir(bench.path("sub")).unwrap();
    for (name, of) in [
        ("rig.csv", "synthetic/practice-01-check.csv"),
        ("plant.toml", "nominal-plant.toml"),
    ] {
        fs::copy(data(of), bench.path(name)).unwrap();
    }
    let controller = bench.run(&["settings", "--toml"]).ended_with(0);
    bench.file("controller.toml", &controller);
    bench.file("profile.csv", "time_s,p_ref_bar_gauge\n0,0\n1,2\n2,2\n");
    bench.file("columns.toml", "# as they are\n");
    bench
}

/// Asserts that the command is refused with `expected`, and that every file is unchanged.
#[track_caller]
fn check(bench: &Bench, arguments: &str, expected: &[&str]) {
    let contents = |bench: &Bench| -> Vec<(String, Option<Vec<u8>>)> {
        let files = bench.files().into_iter();
        files
            .map(|name| (name.clone(), fs::read(bench.path(&name)).ok()))
            .collect()
    };
    let before = contents(bench);
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let ran = bench.run(&arguments);
    assert_contains(&ran.err, expected);
    assert_eq!(
        (ran.status, &*ran.out),
        (2, ""),
        "{arguments:?} {}",
        ran.err
    );
    assert_eq!(contents(bench), before, "{arguments:?}");
}

#[test]
fn an_output_is_no_input_of_its_command() {
    let bench = bench();
    for (arguments, file, input) in [
        ("simulate --log rig.csv --out rig.csv", "rig.csv", "--log"),
        (
            "simulate --log rig.csv --out sub/../rig.csv",
            "rig.csv",
            "--log",
        ),
        (
            "simulate --log rig.csv --json rig.csv --out model.csv",
            "rig.csv",
            "--log",
        ),
        (
            "simulate --log rig.csv --mapping columns.toml --out columns.toml",
            "columns.toml",
            "--mapping",
        ),
        ("compare --log rig.csv --html rig.csv", "rig.csv", "--log"),
        (
            "compare --plant plant.toml --log rig.csv --json plant.toml",
            "plant.toml",
            "--plant",
        ),
        (
            "diagnose --log rig.csv --check log.csv --html log.csv",
            "log.csv",
            "--check",
        ),
        (
            "refine --log rig.csv --add chamber_leak --out rig.csv",
            "rig.csv",
            "--log",
        ),
        (
            "refine --plant plant.toml --log rig.csv --add chamber_leak --out new.toml --json plant.toml",
            "plant.toml",
            "--plant",
        ),
        (
            "next-experiment --log rig.csv --for chamber_leak --out rig.csv",
            "rig.csv",
            "--log",
        ),
        (
            "control --controller controller.toml --out controller.toml",
            "controller.toml",
            "--controller",
        ),
        (
            "control --reference profile.csv --html profile.csv",
            "profile.csv",
            "--reference",
        ),
        (
            "report --log log.csv --log rig.csv --out rig.csv",
            "rig.csv",
            "--log",
        ),
    ] {
        check(
            &bench,
            arguments,
            &[file, &format!("names the file that {input} reads")],
        );
    }
}

#[test]
fn two_results_have_two_files() {
    let bench = bench();
    for (arguments, names) in [
        (
            "compare --log rig.csv --html new --json new",
            ["--html", "--json"],
        ),
        (
            "compare --log rig.csv --html new --json sub/../new",
            ["--html", "--json"],
        ),
        (
            "control --out new.csv --json ./new.csv",
            ["--out", "--json"],
        ),
        (
            "simulate --log rig.csv --out new.csv --json new.csv",
            ["--out", "--json"],
        ),
    ] {
        let expected = [&names[..], &["name the same file"]].concat();
        check(&bench, arguments, &expected);
    }
}

#[cfg(unix)]
#[test]
fn links_and_redirections_do_not_hide_an_input() {
    use std::fs::File;
    use std::os::unix::fs::symlink;

    let bench = bench();
    symlink("rig.csv", bench.path("link.csv")).unwrap();
    fs::hard_link(bench.path("rig.csv"), bench.path("second.csv")).unwrap();
    symlink("../new.csv", bench.path("sub/new.csv")).unwrap();
    for out in ["link.csv", "second.csv"] {
        let arguments = format!("simulate --log rig.csv --out {out}");
        check(&bench, &arguments, &[out, "--log reads"]);
    }
    check(
        &bench,
        "simulate --log rig.csv --out new.csv --json sub/new.csv",
        &["name the same file"],
    );
    let redirected = |arguments: &[&str], to: Option<File>| {
        let mut command = bench.command(arguments);
        command.stdin(File::open(bench.path("rig.csv")).unwrap());
        if let Some(to) = to {
            command.stdout(to);
        }
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let from_input = redirected(&["simulate", "--log", "-", "--out", "rig.csv"], None);
    assert_contains(
        &from_input,
        &["rig.csv: --out names the file that --log reads"],
    );
    let before = bench.read("rig.csv");
    let append = || {
        let options = fs::OpenOptions::new().append(true).clone();
        Some(options.open(bench.path("rig.csv")).unwrap())
    };
    let to_input = redirected(&["simulate", "--log", "rig.csv"], append());
    assert_contains(
        &to_input,
        &["the standard output names the file that --log"],
    );
    let to_other = redirected(&["control", "--json", "rig.csv"], append());
    assert_contains(&to_other, &["the standard output and --json name the same"]);
    assert_eq!(bench.read("rig.csv"), before);
}

/// Repeated refinement of one plant file keeps its mode and its other names.
#[test]
fn refine_replaces_its_own_plant_and_says_so() {
    let bench = bench();
    let arguments: Vec<&str> =
        "refine --plant plant.toml --log rig.csv --add chamber_leak --out sub/../plant.toml"
            .split(' ')
            .collect();
    #[cfg(unix)]
    fs::hard_link(bench.path("plant.toml"), bench.path("second.toml")).unwrap();
    let ran = bench.run(&arguments);
    assert_contains(
        &ran.err,
        &["note: sub/../plant.toml: the file of --plant will be replaced"],
    );
    ran.ended_with(0);
    assert_contains(&bench.read("plant.toml"), &["[effects.chamber_leak]"]);
    #[cfg(unix)]
    assert_eq!(bench.read("second.toml"), bench.read("plant.toml"));
}

#[test]
fn a_report_that_nobody_named_does_not_replace_a_file_of_somebody_else() {
    let bench = bench();
    bench.file("report.html", "<html><body>my thesis</body></html>\n");
    let not_ours = "report.html: exists and is no report of this program";
    let ran = bench.run(&[]);
    assert_eq!((ran.status, &*ran.out), (2, ""));
    assert_contains(&ran.err, &[not_ours, "start in another folder"]);
    check(
        &bench,
        "report --log rig.csv",
        &[not_ours, "another file with --out FILE"],
    );
    assert_contains(&bench.read("report.html"), &["my thesis"]);
    let named: Vec<&str> = "thesis --html report.html".split(' ').collect();
    bench.run(&named).ended_with(0);
    let ours = bench.read("report.html");
    bench.run(&[]).ended_with(0);
    assert_ne!(bench.read("report.html"), ours);
}

#[test]
fn files_stay_with_no_clobber_and_are_replaced_without() {
    let bench = bench();
    bench.file("model.csv", "mine");
    for arguments in [
        "simulate --log log.csv --out model.csv --no-clobber",
        "--no-clobber control --json model.csv",
    ] {
        check(
            &bench,
            arguments,
            &["model.csv: exists, and --no-clobber keeps it"],
        );
    }
    let simulate: Vec<&str> = "simulate --log log.csv --out model.csv"
        .split(' ')
        .collect();
    bench.run(&simulate).ended_with(0);
    assert_contains(&bench.read("model.csv"), &["time_s"]);
    let other = "simulate --no-clobber --log log.csv --out new.csv --json new.json";
    let other: Vec<&str> = other.split(' ').collect();
    bench.run(&other).ended_with(0);
    assert_contains(&bench.read("new.csv"), &["time_s"]);
}

/// A process that waits for its input is killed. The next process in that folder cleans up; the file of a running one
/// stays.
#[cfg(target_os = "linux")]
#[test]
fn what_a_kill_left_is_removed_by_the_next_run() {
    use std::io::Write as _;
    use std::process::Stdio;

    let bench = bench();
    let unfinished = || {
        let names = bench.files().into_iter();
        names
            .filter(|name| name.starts_with(".retarder-unfinished-"))
            .count()
    };
    let start = |out: &str| {
        let mut command = bench.command(&["simulate", "--log", "-", "--out", out]);
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // More rows than one chunk: then the file has begun, and the process waits for the rest.
        let mut rows = "time_s,duty_fill_pct,duty_vent_pct\n".to_owned();
        for row in 0..20_000 {
            rows += &format!("{:.2},0,0\n", f64::from(row) * 0.01);
        }
        let mut input = child.stdin.take().unwrap();
        input.write_all(rows.as_bytes()).unwrap();
        (child, input)
    };
    let (mut killed, _input) = start("killed.csv");
    let (mut running, rest) = start("running.csv");
    while unfinished() < 2 {
        assert!(killed.try_wait().unwrap().is_none());
        assert!(running.try_wait().unwrap().is_none());
        std::thread::yield_now();
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(unfinished(), 2);
    let simulate: Vec<&str> = "simulate --log log.csv --out model.csv"
        .split(' ')
        .collect();
    bench.run(&simulate).ended_with(0);
    assert_eq!(unfinished(), 1);
    drop(rest);
    assert!(running.wait().unwrap().success());
    assert_eq!(unfinished(), 0);
    assert!(bench.files().contains(&"running.csv".to_owned()));
    assert!(!bench.files().contains(&"killed.csv".to_owned()));
}
