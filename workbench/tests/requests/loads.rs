//! Rule 6: limits of size, number and time.

use std::io::{Read, Write};

use crate::bench::{Bench, read_answer};

/// A body without end is cut at the limit, and nothing of it remains; meanwhile only a few chunks are in memory.
#[test]
fn an_endless_upload_is_cut_at_the_limit_in_little_memory() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let mut stream = bench.connect();
    let head = format!(
        "POST {session}/logs?name=endless.csv HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\nSec-Fetch-Site: same-origin\r\n\
         Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n",
        bench.host(),
        browser.cookie
    );
    stream.write_all(head.as_bytes()).unwrap();
    let before = resident_bytes();
    let size = 1 << 20;
    let chunk = [
        format!("{size:x}\r\n").as_bytes(),
        &vec![b'1'; size],
        b"\r\n",
    ]
    .concat();
    let mut most = before;
    for sent in 0..2048 {
        if stream.write_all(&chunk).is_err() {
            break;
        }
        if sent % 64 == 0 {
            most = most.max(resident_bytes());
        }
    }
    let answer = read_answer(&mut stream);
    // The refusal may be lost if the server closes while the client still sends.
    assert!(matches!(answer.status, 413 | 0), "{answer:?}");
    assert!(most - before < 64 << 20, "{} MiB", (most - before) >> 20);
    let left = std::fs::read_dir(bench.folder.path().join("incoming"))
        .unwrap()
        .count();
    assert_eq!(left, 0);
    assert_eq!(
        browser.get(&format!("{session}/project")).json()["logs"]
            .as_array()
            .unwrap()
            .len(),
        0
    );
}

/// No byte of the body is sent: a server that waits for it would not answer.
#[test]
fn a_length_beyond_the_limit_is_refused_at_once() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    for (method, path, length) in [
        (
            "POST",
            format!("{session}/logs?name=a.csv"),
            (1_u64 << 30) + 1,
        ),
        ("POST", format!("{session}/logs?name=a.csv"), u64::MAX - 2),
        ("PUT", format!("{session}/plant"), (2 << 20) + 1),
        ("POST", "/api/sessions".to_owned(), 1 << 40),
    ] {
        let mut stream = bench.connect();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\nSec-Fetch-Site: same-origin\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n",
            bench.host(),
            browser.cookie
        );
        stream.write_all(head.as_bytes()).unwrap();
        let answer = read_answer(&mut stream);
        assert_eq!(
            (answer.status, answer.code().as_str()),
            (413, "E-WEB-TOO-LARGE"),
            "{path} {length}: {answer:?}"
        );
    }
}

fn resident_bytes() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm
        .split(' ')
        .nth(1)
        .and_then(|pages| pages.parse::<u64>().ok());
    pages.unwrap_or(0) * 4096
}

#[test]
fn a_hundred_clients_that_never_finish_their_headers_do_not_keep_others_out() {
    let bench = Bench::start();
    let browser = bench.browser();
    let slow: Vec<_> = (0..100)
        .map(|_| {
            let mut stream = bench.connect();
            stream
                .write_all(b"GET / HTTP/1.1\r\nHost: 127.0.0.1")
                .unwrap();
            stream
        })
        .collect();
    assert_eq!(browser.get("/").status, 200);
    drop(slow);
}

#[test]
fn an_upload_that_breaks_off_leaves_nothing() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let mut stream = bench.connect();
    let head = format!(
        "POST {session}/logs?name=half.csv HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\nSec-Fetch-Site: same-origin\r\n\
         Content-Length: 1000\r\nConnection: close\r\n\r\ntime_s,p_ch",
        bench.host(),
        browser.cookie
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.shutdown(std::net::Shutdown::Write).unwrap();
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    let project = browser.get(&format!("{session}/project")).json();
    assert_eq!(project["logs"].as_array().unwrap().len(), 0);
    assert_eq!(
        std::fs::read_dir(bench.folder.path().join("logs"))
            .unwrap()
            .count(),
        0
    );
}

#[test]
fn a_third_upload_at_the_same_time_has_to_wait() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let open: Vec<_> = (0..2)
        .map(|_| {
            let mut stream = bench.connect();
            let head = format!(
                "POST {session}/logs?name=a.csv HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\nSec-Fetch-Site: same-origin\r\n\
                 Content-Length: 1000\r\nExpect: 100-continue\r\nConnection: close\r\n\r\n",
                bench.host(),
                browser.cookie
            );
            stream.write_all(head.as_bytes()).unwrap();
            // The server requests the body when it has begun to accept it.
            let mut asked = [0; 25];
            stream.read_exact(&mut asked).unwrap();
            assert!(asked.starts_with(b"HTTP/1.1 100"), "{}", String::from_utf8_lossy(&asked));
            stream
        })
        .collect();
    let third = browser.upload(&session, "c.csv", b"time_s,p_ch_bar_gauge\n0,1\n");
    assert_eq!((third.status, third.code()), (429, "E-WEB-BUSY".to_owned()));
    drop(open);
}

#[test]
fn a_project_has_so_many_logs_and_no_more() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let log = b"time_s,p_ch_bar_gauge\n0,1\n1,2\n";
    for count in 0..32 {
        assert_eq!(
            browser.upload(&session, "a.csv", log).status,
            200,
            "{count}"
        );
    }
    let refused = browser.upload(&session, "a.csv", log);
    assert_eq!(
        (refused.status, refused.code()),
        (409, "E-WEB-TOO-MANY".to_owned())
    );
    // The same bytes are stored once.
    assert_eq!(
        std::fs::read_dir(bench.folder.path().join("logs"))
            .unwrap()
            .count(),
        1
    );
}

#[test]
fn what_is_no_http_is_refused_and_the_server_goes_on() {
    let bench = Bench::start();
    let browser = bench.browser();
    for bytes in [
        &b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..],
        b"GET\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"\0\0\0\0\r\n\r\n",
        b"POST /api/sessions HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
        b"POST /api/sessions HTTP/1.1\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\nTransfer-Encoding: x\r\n\r\n",
    ] {
        let answer = bench.raw(&[bytes, b"\r\n\r\n"].concat());
        assert!(matches!(answer.status, 0 | 400 | 421 | 505), "{answer:?}");
    }
    let long = "x".repeat(1 << 20);
    let answer = browser.get(&format!("/{long}"));
    assert!(
        matches!(answer.status, 0 | 400 | 404 | 414 | 431),
        "{}",
        answer.status
    );
    let big = format!("{{\"project\": \"{long}{long}{long}\"}}");
    let answer = browser.send("POST", "/api/sessions", "application/json", big.as_bytes());
    assert!(matches!(answer.status, 0 | 413), "{}", answer.status);
    assert_eq!(browser.get("/").status, 200);
}
