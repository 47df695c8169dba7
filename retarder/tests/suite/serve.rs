//! `serve`: prints its address, and refuses access without it.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::Stdio;

use crate::runner::{Bench, assert_contains};

#[test]
fn the_page_has_an_address_with_a_token_and_refuses_those_without() {
    let bench = Bench::new();
    let mut running = bench
        .command(&["serve", "--project", "kept"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(running.stdout.take().unwrap()).lines();
    let line = lines.next().unwrap().unwrap();
    let address = line.strip_prefix("Open http://").unwrap().to_owned();
    let (host, token) = address.split_once("/?token=").unwrap();
    let send = |request: &str| {
        let mut stream = TcpStream::connect(host).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let ask = |path: &str| {
        send(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        ))
    };
    assert_contains(&ask("/"), &["401 Unauthorized", "retarder serve"]);
    let exchanged = ask(&format!("/?token={token}"));
    assert_contains(&exchanged, &["303 See Other"]);
    let (_, cookie) = exchanged.split_once("set-cookie: ").unwrap();
    let (cookie, _) = cookie.split_once(';').unwrap();
    // The program starts itself again for the work of a tab.
    let body = r#"{"project": null}"#;
    let opened = send(&format!(
        "POST /api/sessions HTTP/1.1\r\nHost: {host}\r\nCookie: {cookie}\r\nOrigin: http://{host}\r\nConnection: close\r\n\
         Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    ));
    assert_contains(&opened, &["200 OK", "\"session\""]);
    running.kill().unwrap();
    running.wait().unwrap();
    assert!(bench.path("kept/logs").is_dir());
}

#[test]
fn a_port_that_is_taken_and_a_folder_that_is_a_file_are_reported_with_what_to_do() {
    let bench = Bench::new();
    let taken = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let ran = bench.run(&["serve", "--port", &port]);
    assert_eq!(ran.status, 2);
    assert_contains(&ran.err, &[&port, "--port"]);
    bench.file("file", "");
    let ran = bench.run(&["serve", "--project", "file"]);
    assert_eq!(ran.status, 2);
    assert_contains(&ran.err, &["file", "--project"]);
}

/// Defect seen: the first start removed a log in a folder named `logs`.
#[test]
fn a_folder_with_files_of_somebody_else_is_refused_and_keeps_them() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("week/logs")).unwrap();
    std::fs::write(bench.path("week/logs/bench.csv"), "time_s\n").unwrap();
    let ran = bench.run(&["serve", "--project", "week"]);
    assert_eq!(ran.status, 2);
    assert_contains(
        &ran.err,
        &["week", "not empty", "--project", "retarder-project.txt"],
    );
    let log = std::fs::read_to_string(bench.path("week/logs/bench.csv"));
    assert_eq!(log.unwrap(), "time_s\n");
    assert!(!bench.path("week/lock").exists());
}
