//! Checks of every request before routing, and headers of every response.
//!
//! The checks, in this order: the target and the `Host` header (an attacker's host name that resolves to this machine
//! differs from ours), the origin of the request (a page of another origin may send but not read), and the secret of
//! this start (other users of the machine may also send requests).

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONNECTION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, COOKIE, HOST, LOCATION,
    ORIGIN, REFERRER_POLICY, SET_COOKIE, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::uri::{Authority, Scheme};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::connections::Place;
use crate::token::Secrets;

/// All content comes from this server, nothing is inline, and strings become markup only through a policy.
const CONTENT_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
     connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; \
     require-trusted-types-for 'script'; trusted-types default";

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
const SEC_FETCH_MODE: HeaderName = HeaderName::from_static("sec-fetch-mode");

/// Secrets and address of this start.
pub(crate) struct Gate {
    pub(crate) port: u16,
    pub(crate) secrets: Secrets,
}

impl Gate {
    /// Returns the name of the cookie. All ports of a host share cookies, so two servers need two names.
    fn cookie_name(&self) -> String {
        format!("retarder-{}", self.port)
    }

    fn is_our_host(&self, host: &str) -> bool {
        let port = self.port;
        ["127.0.0.1", "localhost", "[::1]"]
            .iter()
            .any(|name| host == format!("{name}:{port}"))
    }

    /// Returns whether the target of a request is an absolute address of another server. Such a target has precedence
    /// over the `Host` header (RFC 9112, section 3.2.2).
    fn is_misdirected(&self, target: &Uri) -> bool {
        let is_foreign = |authority: &Authority| !self.is_our_host(authority.as_str());
        target.authority().is_some_and(is_foreign)
            || target
                .scheme()
                .is_some_and(|scheme| *scheme != Scheme::HTTP)
    }

    fn has_cookie(&self, headers: &HeaderMap) -> bool {
        let name = self.cookie_name();
        headers
            .get_all(COOKIE)
            .iter()
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(';'))
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(key, value)| key == name && self.secrets.is_cookie(value))
    }

    /// Returns the answer to a request that may not pass; `None` lets it pass.
    fn refusal(&self, request: &Request) -> Option<Response> {
        let headers = request.headers();
        if self.is_misdirected(request.uri()) {
            return Some(misdirected());
        }
        let Some(host) = only(headers, HOST).filter(|host| self.is_our_host(host)) else {
            return Some(misdirected());
        };
        if !is_from_our_page(request.method(), headers, host) {
            return Some(plain(
                StatusCode::FORBIDDEN,
                "Only the page of this server may ask this.\n",
            ));
        }
        // Only GET counts: a HEAD request does not use up the token of the address.
        let token = (request.method() == Method::GET && request.uri().path() == "/")
            .then(|| token_of(request.uri().query().unwrap_or("")))
            .flatten();
        match (self.has_cookie(headers), token) {
            (true, None) => {
                if let Some(place) = request.extensions().get::<Place>() {
                    place.prove();
                }
                None
            }
            // The address was opened again: redirect, so that the address bar does not show the secret.
            (true, Some(_)) => Some(to_the_page(None)),
            (false, Some(token)) => match self.secrets.exchange(token) {
                Some(cookie) => Some(to_the_page(Some(format!(
                    "{}={cookie}; Path=/; HttpOnly; SameSite=Strict",
                    self.cookie_name()
                )))),
                None => Some(unauthorised()),
            },
            (false, None) => Some(unauthorised()),
        }
    }
}

/// Returns the one value of a header; `None` if it is absent, repeated or not text.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (Some(value), None) => value.to_str().ok(),
        _ => None,
    }
}

/// Returns whether the request comes from a page of this server, or from a user who entered the address.
fn is_from_our_page(method: &Method, headers: &HeaderMap, host: &str) -> bool {
    let origin = match headers.get_all(ORIGIN).iter().count() {
        0 => None,
        _ => Some(only(headers, ORIGIN).is_some_and(|origin| origin == format!("http://{host}"))),
    };
    let site = match headers.get_all(SEC_FETCH_SITE).iter().count() {
        0 => None,
        _ => only(headers, SEC_FETCH_SITE).or(Some("")),
    };
    let reads_only = matches!(*method, Method::GET | Method::HEAD);
    let is_navigation = only(headers, SEC_FETCH_MODE) == Some("navigate");
    match (origin, site) {
        (Some(false), _) => false,
        (_, Some("same-origin")) => true,
        (_, Some("none")) => reads_only || origin == Some(true),
        // A link from another site may open the page; it brings no cookie.
        (_, Some(_)) => reads_only && is_navigation,
        (Some(true), None) => true,
        (None, None) => reads_only,
    }
}

fn token_of(query: &str) -> Option<&str> {
    query
        .split('&')
        .find_map(|pair| pair.strip_prefix("token="))
}

fn to_the_page(cookie: Option<String>) -> Response {
    let mut response = (StatusCode::SEE_OTHER, [(LOCATION, "/")]).into_response();
    if let Some(cookie) = cookie.and_then(|cookie| HeaderValue::try_from(cookie).ok()) {
        response.headers_mut().insert(SET_COOKIE, cookie);
    }
    response
}

fn misdirected() -> Response {
    plain(
        StatusCode::MISDIRECTED_REQUEST,
        "This server answers to the address that `retarder serve` printed, and to no other.\n",
    )
}

fn unauthorised() -> Response {
    plain(
        StatusCode::UNAUTHORIZED,
        "This page opens with the address that `retarder serve` printed; each start has its own, and it is good for one \
         browser. Start it again for another.\n",
    )
}

/// Creates the last response of a connection, with its reason.
fn plain(status: StatusCode, text: &'static str) -> Response {
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (CONNECTION, "close"),
    ];
    (status, headers, Body::from(text)).into_response()
}

/// Lets a request pass or answers it, and adds the same headers to every response.
pub(crate) async fn guard(State(gate): State<Arc<Gate>>, request: Request, next: Next) -> Response {
    let mut response = match gate.refusal(&request) {
        Some(response) => response,
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    // A document with its own policy keeps it.
    headers
        .entry(CONTENT_SECURITY_POLICY)
        .or_insert(HeaderValue::from_static(CONTENT_POLICY));
    let mut set = |name: HeaderName, value: &'static str| {
        headers.insert(name, HeaderValue::from_static(value));
    };
    set(X_CONTENT_TYPE_OPTIONS, "nosniff");
    set(REFERRER_POLICY, "no-referrer");
    set(CACHE_CONTROL, "no-store");
    set(
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    );
    set(
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    );
    response
}
