//! Requests in the form that the page sends.

use std::io::{self, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::{Value, json};

/// Longest wait for an answer. It only ends a run that hangs; no result depends on it.
const PATIENCE: Duration = Duration::from_secs(60);

/// Browser with the cookie.
#[derive(Debug, Clone)]
pub(crate) struct Client {
    host: String,
    cookie: String,
}

/// Response of the server.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> io::Result<Value> {
        Ok(serde_json::from_slice(&self.body)?)
    }
}

impl Client {
    /// Exchanges the token of the printed address, `127.0.0.1:PORT/?token=…`, for a cookie.
    pub(crate) fn open(address: &str) -> io::Result<Self> {
        let broken = || io::Error::other(format!("no address with a token: {address}"));
        let (host, token) = address.split_once("/?token=").ok_or_else(broken)?;
        let mut client = Self {
            host: host.to_owned(),
            cookie: String::new(),
        };
        let answer = client.send(
            "GET",
            &format!("/?token={}", token.trim()),
            "text/html",
            b"",
        )?;
        let lines = answer.head.lines().filter_map(|line| line.split_once(": "));
        let mut cookies = lines.filter(|(key, _)| key.eq_ignore_ascii_case("set-cookie"));
        let cookie = cookies
            .next()
            .and_then(|(_, value)| value.split(';').next());
        client.cookie = cookie.ok_or_else(broken)?.to_owned();
        Ok(client)
    }

    /// Opens a session as a tab does, and returns its path.
    pub(crate) fn session(&self, project: Option<&str>) -> io::Result<String> {
        let opened = self.post("/api/sessions", &json!({ "project": project }))?;
        let opened = opened.json()?;
        match opened["session"].as_str() {
            Some(id) => Ok(format!("/api/sessions/{id}")),
            None => Err(io::Error::other(format!("no session: {opened}"))),
        }
    }

    pub(crate) fn get(&self, path: &str) -> io::Result<Answer> {
        self.send("GET", path, "application/json", b"")
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> io::Result<Answer> {
        self.send(
            "POST",
            path,
            "application/json",
            body.to_string().as_bytes(),
        )
    }

    pub(crate) fn put(&self, path: &str, body: &Value) -> io::Result<Answer> {
        self.send("PUT", path, "application/json", body.to_string().as_bytes())
    }

    pub(crate) fn upload(&self, session: &str, name: &str, bytes: &[u8]) -> io::Result<Answer> {
        let path = format!("{session}/logs?name={name}");
        self.send("POST", &path, "application/octet-stream", bytes)
    }

    /// Begins a job of a session and waits for its end, with any result.
    pub(crate) fn work(&self, session: &str, what: &str, request: &Value) -> io::Result<()> {
        let begun = self.post(&format!("{session}/{what}"), request)?;
        match begun.json().ok().and_then(|begun| begun["job"].as_u64()) {
            Some(job) => self.get(&format!("{session}/jobs/{job}")).map(drop),
            None => Ok(()),
        }
    }

    fn send(&self, method: &str, path: &str, kind: &str, body: &[u8]) -> io::Result<Answer> {
        let mut stream = TcpStream::connect(&self.host)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let mut head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nSec-Fetch-Site: same-origin\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n",
            self.host,
            body.len()
        );
        if !self.cookie.is_empty() {
            head += &format!("Cookie: {}\r\n", self.cookie);
        }
        stream.write_all(&[head.as_bytes(), b"\r\n", body].concat())?;
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes)?;
        let broken_off = || io::Error::from(io::ErrorKind::UnexpectedEof);
        let end = bytes
            .windows(4)
            .position(|window| window == b"\r\n\r\n")
            .ok_or_else(broken_off)?;
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|word| word.parse().ok());
        let body = bytes.split_off(end + 4);
        // An incomplete answer of a server that died counts as no answer.
        let length = head.lines().filter_map(|line| line.split_once(": "));
        let length = length
            .filter(|(key, _)| key.eq_ignore_ascii_case("content-length"))
            .find_map(|(_, value)| value.parse::<usize>().ok());
        if length.is_some_and(|length| length != body.len()) {
            return Err(broken_off());
        }
        Ok(Answer {
            status: status.ok_or_else(broken_off)?,
            head,
            body,
        })
    }
}
