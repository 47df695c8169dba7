//! A server of its own for each test, and a client that sends exactly the given bytes.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::thread::JoinHandle;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;
use workbench::{Options, Server, Stopper, Worker};

/// Running server with an open session.
pub(crate) struct Bench {
    pub(crate) port: u16,
    pub(crate) token: String,
    pub(crate) folder: TempDir,
    running: Option<(Stopper, JoinHandle<()>)>,
}

/// Response of the server.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    /// Header lines in lower case.
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let lines = self.head.lines();
        let mut pairs = lines.filter_map(|line| line.split_once(": "));
        pairs.find(|(key, _)| *key == name).map(|(_, value)| value)
    }

    /// Returns the code of the first problem.
    pub(crate) fn code(&self) -> String {
        self.json()["problems"][0]["code"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }
}

impl Bench {
    pub(crate) fn start() -> Self {
        Self::start_in(tempfile::tempdir().unwrap())
    }

    pub(crate) fn start_in(folder: TempDir) -> Self {
        Self::run(folder, worker(Worker::MEMORY_BYTES))
    }

    /// Starts a server whose tabs have another limit of memory.
    pub(crate) fn with_worker(worker: Worker) -> Self {
        Self::run(tempfile::tempdir().unwrap(), worker)
    }

    fn run(folder: TempDir, worker: Worker) -> Self {
        let server = serve(folder.path(), worker);
        let address = server.address();
        let (base, token) = address.split_once("/?token=").unwrap();
        let port = base.rsplit(':').next().unwrap().parse().unwrap();
        let token = token.to_owned();
        let stopper = server.stopper();
        let thread = std::thread::spawn(move || server.run().unwrap());
        Self {
            port,
            token,
            folder,
            running: Some((stopper, thread)),
        }
    }

    /// Ends the server and starts another one on its folder.
    pub(crate) fn restart(mut self) -> Self {
        self.stop();
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir().unwrap());
        Self::start_in(folder)
    }

    fn stop(&mut self) {
        if let Some((stopper, thread)) = self.running.take() {
            stopper.stop();
            thread.join().unwrap();
        }
    }

    /// Sends these bytes, and reads until the server closes or the response is complete.
    pub(crate) fn raw(&self, request: &[u8]) -> Answer {
        self.raw_to("127.0.0.1", request)
    }

    fn raw_to(&self, address: &str, request: &[u8]) -> Answer {
        let mut stream = self.connect_to(address);
        // A server that refuses early closes while the rest is still being sent.
        let _ = stream.write_all(request);
        read_answer(&mut stream)
    }

    pub(crate) fn connect(&self) -> TcpStream {
        self.connect_to("127.0.0.1")
    }

    fn connect_to(&self, address: &str) -> TcpStream {
        let stream = TcpStream::connect((address, self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        stream
    }

    pub(crate) fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// Sends a request with these header lines and no others than `Connection: close`.
    pub(crate) fn send(&self, method: &str, path: &str, headers: &[&str], body: &[u8]) -> Answer {
        self.send_to("127.0.0.1", method, path, headers, body)
    }

    /// Sends the same request to another address of the loopback interface.
    pub(crate) fn send_to(
        &self,
        address: &str,
        method: &str,
        path: &str,
        headers: &[&str],
        body: &[u8],
    ) -> Answer {
        let mut request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
        for header in headers {
            request += header;
            request += "\r\n";
        }
        if !body.is_empty() || !matches!(method, "GET" | "HEAD" | "OPTIONS") {
            request += &format!("Content-Length: {}\r\n", body.len());
        }
        request += "\r\n";
        self.raw_to(address, &[request.as_bytes(), body].concat())
    }

    /// Returns the cookie for the token.
    pub(crate) fn cookie(&self) -> String {
        let host = format!("Host: {}", self.host());
        let path = format!("/?token={}", self.token);
        let answer = self.send("GET", &path, &[&host], b"");
        assert_eq!(answer.status, 303, "{answer:?}");
        let cookie = answer.header("set-cookie").unwrap();
        cookie.split(';').next().unwrap().to_owned()
    }

    /// Returns a browser with the cookie.
    pub(crate) fn browser(&self) -> Browser<'_> {
        Browser {
            bench: self,
            cookie: self.cookie(),
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        if let Some((stopper, _)) = self.running.take() {
            stopper.stop();
        }
    }
}

/// Returns the program of a tab's process.
pub(crate) fn worker(memory_bytes: u64) -> Worker {
    Worker {
        program: env!("CARGO_BIN_EXE_workbench-tab").into(),
        arguments: Vec::new(),
        memory_bytes,
    }
}

/// Starts a server on a free port, since tests run in parallel.
fn serve(folder: &Path, worker: Worker) -> Server {
    let options = Options {
        project: folder.to_path_buf(),
        port: Some(0),
        worker,
    };
    Server::bind(&options).unwrap()
}

/// Client that sends requests in the form of the page.
pub(crate) struct Browser<'a> {
    pub(crate) bench: &'a Bench,
    pub(crate) cookie: String,
}

impl Browser<'_> {
    pub(crate) fn send(&self, method: &str, path: &str, kind: &str, body: &[u8]) -> Answer {
        let headers = [
            format!("Host: {}", self.bench.host()),
            format!("Cookie: {}", self.cookie),
            "Sec-Fetch-Site: same-origin".to_owned(),
            format!("Content-Type: {kind}"),
        ];
        let headers: Vec<&str> = headers.iter().map(String::as_str).collect();
        self.bench.send(method, path, &headers, body)
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.send("GET", path, "application/json", b"")
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> Answer {
        self.send(
            "POST",
            path,
            "application/json",
            body.to_string().as_bytes(),
        )
    }

    pub(crate) fn put(&self, path: &str, body: &Value) -> Answer {
        self.send("PUT", path, "application/json", body.to_string().as_bytes())
    }

    /// Opens a session as a tab does, and returns its path.
    pub(crate) fn session(&self, project: Option<&str>) -> String {
        let opened = self.post("/api/sessions", &serde_json::json!({ "project": project }));
        assert_eq!(opened.status, 200, "{opened:?}");
        format!(
            "/api/sessions/{}",
            opened.json()["session"].as_str().unwrap()
        )
    }

    pub(crate) fn upload(&self, session: &str, name: &str, bytes: &[u8]) -> Answer {
        let path = format!("{session}/logs?name={name}");
        self.send("POST", &path, "application/octet-stream", bytes)
    }

    /// Compares a log and waits for the end; returns the last event.
    pub(crate) fn compare(&self, session: &str, log: u64) -> Value {
        let path = format!("{session}/logs/{log}/compare");
        let mut events = self.work(session, &path, &serde_json::json!({}));
        events.pop().unwrap()
    }

    /// Follows a job like a page that may close, as soon as the job runs.
    pub(crate) fn follow(&self, session: &str, job: u64) -> TcpStream {
        let mut events = self.bench.connect();
        let request = format!(
            "GET {session}/jobs/{job} HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\nConnection: close\r\n\r\n",
            self.bench.host(),
            self.cookie
        );
        events.write_all(request.as_bytes()).unwrap();
        let mut first = [0; 64];
        events.read_exact(&mut first).unwrap();
        events
    }

    /// Begins a job and waits for its end; returns all events.
    pub(crate) fn work(&self, session: &str, path: &str, request: &Value) -> Vec<Value> {
        let begun = self.post(path, request);
        assert_eq!(begun.status, 200, "{begun:?}");
        let job = begun.json()["job"].as_u64().unwrap();
        let events = self.get(&format!("{session}/jobs/{job}")).text();
        let events = events
            .lines()
            .filter_map(|line| line.strip_prefix("data: "));
        events
            .map(|event| serde_json::from_str(event).unwrap())
            .collect()
    }
}

pub(crate) fn read_answer(stream: &mut TcpStream) -> Answer {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let end = bytes
        .windows(4)
        .position(|window| window == b"\r\n\r\n")
        .unwrap_or(bytes.len());
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let status = head.split(' ').nth(1).and_then(|word| word.parse().ok());
    let body = bytes.get(end + 4..).unwrap_or_default();
    let head = head.to_lowercase();
    let is_chunked = head.contains("transfer-encoding: chunked");
    Answer {
        status: status.unwrap_or(0),
        body: if is_chunked {
            unchunked(body)
        } else {
            body.to_vec()
        },
        head,
    }
}

fn unchunked(mut rest: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some(end) = rest.windows(2).position(|window| window == b"\r\n") {
        let size = std::str::from_utf8(&rest[..end]).ok();
        let size = size
            .and_then(|text| usize::from_str_radix(text, 16).ok())
            .unwrap_or(0);
        let from = end + 2;
        let Some(chunk) = rest.get(from..from + size).filter(|_| size > 0) else {
            break;
        };
        body.extend_from_slice(chunk);
        rest = &rest[from + size + 2..];
    }
    body
}
