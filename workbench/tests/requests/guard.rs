//! Access control, and headers of every answer. The numbers are those of the rules in the project's threat list.

use std::net::TcpListener;

use crate::bench::Bench;

/// Rule 1: only 127.0.0.1 and `[::1]`.
#[test]
fn the_server_listens_on_the_loopback_interface_only() {
    const LOOPBACK: [&str; 2] = ["0100007F", "00000000000000000000000001000000"];
    const LISTENS: &str = "0A";
    let bench = Bench::start();
    let port = format!("{:04X}", bench.port);
    for family in ["tcp", "tcp6"] {
        let sockets = std::fs::read_to_string(format!("/proc/net/{family}")).unwrap_or_default();
        for line in sockets.lines() {
            let [_, local, _, state, ..] = line.split_whitespace().collect::<Vec<_>>()[..] else {
                continue;
            };
            if let Some((address, there)) = local.split_once(':')
                && (there, state) == (&port[..], LISTENS)
            {
                assert!(LOOPBACK.contains(&address), "{family}: {line}");
            }
        }
    }
}

/// Rule 1, second part: a client that uses IPv6 for `localhost` gets the same page.
#[test]
fn the_page_is_there_on_both_families() {
    let bench = Bench::start();
    let cookie = format!("Cookie: {}", bench.cookie());
    for (address, host) in [
        ("127.0.0.1", "127.0.0.1"),
        ("::1", "[::1]"),
        ("::1", "localhost"),
    ] {
        let is_there = TcpListener::bind((address, 0)).is_ok();
        if !is_there {
            // A machine without IPv6 has no second address to serve.
            assert_eq!(address, "::1");
            continue;
        }
        let host = format!("Host: {host}:{}", bench.port);
        let answer = bench.send_to(address, "GET", "/", &[&host, &cookie], b"");
        assert_eq!(answer.status, 200, "{address} {host}: {answer:?}");
    }
}

/// Rule 2: another host name that resolves to this machine is refused, for any method and path.
#[test]
fn another_host_is_refused_before_anything_else() {
    let bench = Bench::start();
    let cookie = format!("Cookie: {}", bench.cookie());
    let port = bench.port;
    let foreign = [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        format!("localhost.:{port}"),
        format!("127.0.0.1:{}", port ^ 1),
        "127.0.0.1".to_owned(),
        "localhost".to_owned(),
        format!("0.0.0.0:{port}"),
        format!("127.1:{port}"),
        format!("127.0.0.2:{port}"),
        "[::1]".to_owned(),
        format!("[::]:{port}"),
        format!("[::ffff:127.0.0.1]:{port}"),
        format!("::1:{port}"),
        format!("user@127.0.0.1:{port}"),
        format!("127.0.0.1:{port}@evil.example"),
        format!("127.0.0.1:0{port}"),
        format!("LOCALHOST.evil:{port}"),
        String::new(),
    ];
    for host in &foreign {
        for (method, path) in [
            ("GET", "/"),
            ("POST", "/api/sessions"),
            ("OPTIONS", "/api/examples"),
            ("GET", "/nothing"),
        ] {
            let host = format!("Host: {host}");
            let answer = bench.send(
                method,
                path,
                &[&host, &cookie, "Sec-Fetch-Site: same-origin"],
                b"",
            );
            assert_eq!(answer.status, 421, "{method} {path} {host}: {answer:?}");
        }
    }
    let ours = format!("Host: 127.0.0.1:{port}");
    for hosts in [
        vec![],
        vec![&ours[..], &ours[..]],
        vec![&ours[..], "Host: evil.example"],
    ] {
        let headers: Vec<&str> = hosts.into_iter().chain([&cookie[..]]).collect();
        let answer = bench.send("GET", "/", &headers, b"");
        assert!(
            matches!(answer.status, 400 | 421),
            "{headers:?}: {answer:?}"
        );
    }
    // A target with a full address has precedence over the Host header.
    for target in [
        "http://evil.example/".to_owned(),
        format!("http://evil.example:{port}/api/examples"),
        format!("http://user@127.0.0.1:{port}/"),
        format!("http://127.0.0.1:{}/", port ^ 1),
        format!("https://127.0.0.1:{port}/"),
        format!("ftp://127.0.0.1:{port}/"),
    ] {
        let answer = bench.send("GET", &target, &[&ours, &cookie], b"");
        assert_eq!(answer.status, 421, "{target}: {answer:?}");
    }
    let target = format!("http://127.0.0.1:{port}/");
    assert_eq!(
        bench.send("GET", &target, &[&ours, &cookie], b"").status,
        200
    );
    for host in [
        format!("Host: 127.0.0.1:{port}"),
        format!("Host: localhost:{port}"),
        format!("Host: [::1]:{port}"),
    ] {
        assert_eq!(
            bench.send("GET", "/", &[&host, &cookie], b"").status,
            200,
            "{host}"
        );
    }
}

/// Rule 3: a page of another origin can send requests to this machine; none of them is carried out.
#[test]
fn requests_of_other_pages_are_refused_and_nobody_gets_cross_origin_headers() {
    let bench = Bench::start();
    let cookie = format!("Cookie: {}", bench.cookie());
    let host = format!("Host: {}", bench.host());
    let own = format!("Origin: http://{}", bench.host());
    let other_port = format!("Origin: http://127.0.0.1:{}", bench.port ^ 1);
    let secure = format!("Origin: https://{}", bench.host());
    let refused: [&[&str]; 12] = [
        &["Sec-Fetch-Site: cross-site"],
        &["Sec-Fetch-Site: same-site"],
        &["Sec-Fetch-Site: none"],
        &["Sec-Fetch-Site: Same-Origin"],
        &["Sec-Fetch-Site: same-origin", "Sec-Fetch-Site: cross-site"],
        &["Origin: null"],
        &["Origin: http://evil.example"],
        &[&other_port],
        &[&secure],
        &[&own, "Origin: http://evil.example"],
        &["Sec-Fetch-Site: same-origin", "Origin: http://evil.example"],
        &[],
    ];
    for headers in refused {
        for (kind, body) in [
            (
                "Content-Type: application/json",
                &br#"{"project":null}"#[..],
            ),
            ("Content-Type: text/plain", br#"{"project":null}"#),
            (
                "Content-Type: application/x-www-form-urlencoded",
                b"project=",
            ),
        ] {
            let all: Vec<&str> = [&host[..], &cookie[..], kind]
                .into_iter()
                .chain(headers.iter().copied())
                .collect();
            let answer = bench.send("POST", "/api/sessions", &all, body);
            assert_eq!(answer.status, 403, "{all:?}: {answer:?}");
            assert!(!answer.head.contains("access-control"), "{answer:?}");
        }
    }
    for headers in [
        &["Sec-Fetch-Site: same-origin"][..],
        &[&own[..]],
        &[&own[..], "Sec-Fetch-Site: same-origin"],
    ] {
        let all: Vec<&str> = [&host[..], &cookie[..], "Content-Type: application/json"]
            .into_iter()
            .chain(headers.iter().copied())
            .collect();
        let answer = bench.send("POST", "/api/sessions", &all, br#"{"project":null}"#);
        assert_eq!(answer.status, 200, "{all:?}: {answer:?}");
    }
    // Reading is also refused if another page does it, rather than a user who followed a link.
    let asked = |headers: &[&str]| {
        let all: Vec<&str> = [&host[..], &cookie[..]]
            .into_iter()
            .chain(headers.iter().copied())
            .collect();
        bench.send("GET", "/api/examples", &all, b"").status
    };
    assert_eq!(
        asked(&["Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: no-cors"]),
        403
    );
    assert_eq!(
        asked(&[
            "Sec-Fetch-Site: cross-site",
            "Sec-Fetch-Mode: cors",
            "Origin: http://evil.example"
        ]),
        403
    );
    assert_eq!(asked(&["Sec-Fetch-Site: same-origin"]), 200);
    let preflight = bench.send(
        "OPTIONS",
        "/api/sessions",
        &[
            &host,
            "Origin: http://evil.example",
            "Access-Control-Request-Method: POST",
        ],
        b"",
    );
    assert_eq!(preflight.status, 403);
    assert!(!preflight.head.contains("access-control"), "{preflight:?}");
}

/// Rule 4: without the secret of this start there is no access, and the token of the address can be exchanged once.
#[test]
fn the_token_opens_the_page_once_and_only_the_cookie_opens_it_again() {
    let bench = Bench::start();
    let host = format!("Host: {}", bench.host());
    for path in [
        "/",
        "/assets/main.js",
        "/assets/plotly.js",
        "/api/examples",
        "/nothing",
        "/?token=",
        "/?token=0",
    ] {
        assert_eq!(bench.send("GET", path, &[&host], b"").status, 401, "{path}");
    }
    let almost = format!("/?token={}x", &bench.token[..31]);
    assert_eq!(bench.send("GET", &almost, &[&host], b"").status, 401);
    // The token gives no access at any other path, and is not a cookie.
    let elsewhere = format!("/api/examples?token={}", bench.token);
    assert_eq!(bench.send("GET", &elsewhere, &[&host], b"").status, 401);
    let name = format!("retarder-{}", bench.port);
    for cookie in [
        format!("Cookie: {name}={}", bench.token),
        format!("Cookie: {name}="),
        format!("Cookie: x={name}"),
    ] {
        assert_eq!(
            bench.send("GET", "/", &[&host, &cookie], b"").status,
            401,
            "{cookie}"
        );
    }

    let with_token = format!("/?token={}", bench.token);
    // Defect seen: a mail program that checked the link before the user opened it used the token up.
    for method in ["HEAD", "POST", "OPTIONS"] {
        let origin = format!("Origin: http://{}", bench.host());
        let refused = bench.send(method, &with_token, &[&host, &origin], b"");
        assert_eq!(refused.status, 401, "{method}");
    }
    let exchanged = bench.send("GET", &with_token, &[&host], b"");
    assert_eq!(
        (exchanged.status, exchanged.header("location")),
        (303, Some("/"))
    );
    let set = exchanged.header("set-cookie").unwrap().to_owned();
    for part in ["httponly", "samesite=strict", "path=/"] {
        assert!(set.contains(part), "{set}");
    }
    assert!(
        !set.contains(&bench.token),
        "the cookie is another secret: {set}"
    );
    assert_eq!(
        bench.send("GET", &with_token, &[&host], b"").status,
        401,
        "a second time"
    );
    let cookie = format!("Cookie: a=b; {}", set.split(';').next().unwrap());
    assert_eq!(bench.send("GET", "/", &[&host, &cookie], b"").status, 200);
    // The user opens the printed address again: the page is shown, and the address bar contains no token.
    let again = bench.send("GET", &with_token, &[&host, &cookie], b"");
    assert_eq!((again.status, again.header("location")), (303, Some("/")));
}

/// Rules 7 and 10: the headers of every answer, including refusals, and the information that a client without access
/// gets.
#[test]
fn every_answer_forbids_what_the_page_does_not_need_and_reveals_nothing_of_the_machine() {
    let bench = Bench::start();
    let browser = bench.browser();
    let host = format!("Host: {}", bench.host());
    let session = browser.session(None);
    let answers = [
        bench.send("GET", "/", &["Host: evil.example"], b""),
        bench.send("GET", "/", &[&host], b""),
        bench.send("POST", "/api/sessions", &[&host, "Origin: null"], b"{}"),
        browser.get("/"),
        browser.get("/assets/main.js"),
        browser.get("/assets/plotly.js"),
        browser.get("/assets/style.css"),
        browser.get("/assets/nothing"),
        browser.get("/nothing"),
        browser.get("/api/nothing"),
        browser.get(&format!("{session}/project")),
        browser.get(&format!("{session}/logs/9/preview")),
        browser.get(&format!("{session}/logs/x/preview")),
        browser.post("/api/sessions", &serde_json::json!([])),
        browser.post(
            &format!("{session}/examples/nothing"),
            &serde_json::json!({"keep": false}),
        ),
        browser.send("DELETE", "/", "text/plain", b""),
    ];
    let folder = bench.folder.path().to_str().unwrap();
    for answer in &answers {
        let policy = answer.header("content-security-policy").unwrap();
        for part in [
            "default-src 'none'",
            "script-src 'self';",
            "style-src 'self';",
            "frame-ancestors 'none'",
            "require-trusted-types-for 'script'",
        ] {
            assert!(policy.contains(part), "{policy}");
        }
        assert!(
            !policy.contains("unsafe") && !policy.contains("http"),
            "{policy}"
        );
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cache-control", "no-store"),
            ("cross-origin-opener-policy", "same-origin"),
            ("cross-origin-resource-policy", "same-origin"),
        ] {
            assert_eq!(answer.header(name), Some(value), "{}", answer.head);
        }
        let text = answer.text();
        // The library contains examples of addresses; it is not searched.
        if answer.body.len() < 100_000 {
            for secret in [folder, "src/", ".rs:", "panicked", "/root", "/home"] {
                assert!(!text.contains(secret), "{secret}: {text}");
            }
        }
    }
}

/// Rule 5: a text that looks like a path is looked up in a list of names, and never reaches the disk.
#[test]
fn no_path_of_a_request_reaches_the_disk() {
    let bench = Bench::start();
    let browser = bench.browser();
    std::fs::write(bench.folder.path().join("secret"), "SECRET").unwrap();
    let session = browser.session(None);
    let outside = [
        "../secret",
        "../../secret",
        "%2e%2e%2fsecret",
        "%252e%252e%252fsecret",
        "..%5csecret",
        "..\\secret",
        "....//secret",
        "/etc/passwd",
        "//etc/passwd",
        "%2fetc%2fpasswd",
        "C:%5cWindows",
        "CON",
        "%00",
        "main.js%00",
        "main.js/",
        "./main.js",
        "pages/../main.js",
        "%5c%5cserver%5cshare",
        "logs/../../secret",
        "Main.js",
    ];
    let nothing = browser.get("/assets/nothing");
    for path in outside {
        let answer = browser.get(&format!("/assets/{path}"));
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
        if answer.status == 404 && answer.header("content-type") == nothing.header("content-type") {
            assert_eq!(answer.body, nothing.body, "{path}");
        }
        let answer = browser.get(&format!("/api/sessions/{path}/project"));
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
        let answer = browser.post(
            &format!("{session}/examples/{path}"),
            &serde_json::json!({"keep": true}),
        );
        assert!(
            matches!(answer.status, 400 | 404 | 405),
            "{path}: {answer:?}"
        );
        let answer = browser.post("/api/sessions", &serde_json::json!({"project": path}));
        assert_eq!(
            answer.status, 200,
            "a project that is not there is a new one: {answer:?}"
        );
        let answer = browser.upload(&session, path, b"time_s,p_ch_bar_gauge\n0,1\n1,2\n");
        assert!(
            matches!(answer.status, 200 | 400 | 409),
            "{path}: {answer:?}"
        );
    }
    let mut found: Vec<String> = Vec::new();
    for folder in ["logs", "projects", "incoming"] {
        for entry in std::fs::read_dir(bench.folder.path().join(folder)).unwrap() {
            found.push(entry.unwrap().file_name().into_string().unwrap());
        }
    }
    for name in &found {
        let stem = name.strip_suffix(".json").unwrap_or(name);
        assert!(stem.bytes().all(|byte| byte.is_ascii_hexdigit()), "{name}");
    }
}
