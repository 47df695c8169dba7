//! Browser, server, and the actions of a user.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use fantoccini::actions::{
    InputSource, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions, PointerAction,
};
use fantoccini::{Client, ClientBuilder, Locator};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use tempfile::TempDir;
use workbench::{Options, ServeError, Server, Stopper, Worker};

/// Longest wait for the page: the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// Browser with one window on a page of its own server.
pub(crate) struct Person {
    pub(crate) client: Client,
    pub(crate) address: String,
    _driver: DriverProcess,
    server: Mutex<Running>,
    /// Project folder, and profile of the browser.
    folders: [TempDir; 2],
}

/// Returns the program of a tab's process.
pub(crate) fn worker() -> Worker {
    Worker {
        program: env!("CARGO_BIN_EXE_workbench-tab").into(),
        arguments: Vec::new(),
        memory_bytes: Worker::MEMORY_BYTES,
    }
}

/// Process that ends with its browser, whatever a test does.
struct DriverProcess(Child);

impl Drop for DriverProcess {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

struct Running(Stopper);

impl Running {
    fn start(server: Server) -> Self {
        let running = Self(server.stopper());
        std::thread::spawn(move || server.run());
        running
    }
}

fn bind(project: &TempDir, port: u16) -> Result<Server, ServeError> {
    Server::bind(&Options {
        project: project.path().to_path_buf(),
        port: Some(port),
        worker: worker(),
    })
}

impl Drop for Running {
    fn drop(&mut self) {
        self.0.stop();
    }
}

/// Runs `test` with a new browser, and closes it afterwards.
pub(crate) fn with_browser(test: impl AsyncFnOnce(&Person)) {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(async {
        let person = Person::sit_down().await;
        test(&person).await;
        person.client.clone().close().await.unwrap();
    });
}

impl Person {
    async fn sit_down() -> Self {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let server = bind(&folders[0], 0).unwrap();
        let address = server.address();
        let running = Running::start(server);
        let port = TcpListener::bind(("127.0.0.1", 0))
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let driver = Command::new("chromedriver")
            .args([&format!("--port={port}"), "--allowed-ips=127.0.0.1"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| {
                panic!("chromedriver: {error}; sudo apt-get install -y chromium chromium-driver")
            });
        let driver = DriverProcess(driver);
        let client = connect(port, &folders[1]).await;
        let person = Self {
            client,
            address,
            _driver: driver,
            server: Mutex::new(running),
            folders,
        };
        person.client.set_window_size(1280, 1000).await.unwrap();
        person.client.goto(&person.address).await.unwrap();
        person.until("document.body.dataset.ready === 'logs'").await;
        person.watch_the_policy().await;
        person
    }

    /// Counts the refusals of the content policy, and every dialogue.
    pub(crate) async fn watch_the_policy(&self) {
        self.run(
            "window.refused = []; \
             document.addEventListener('securitypolicyviolation', (event) => refused.push(event.violatedDirective + ' ' + event.sourceFile)); \
             window.alert = () => refused.push('a dialogue');",
        )
        .await;
    }

    pub(crate) async fn assert_nothing_was_refused(&self) {
        assert_eq!(self.run("return window.refused").await, json!([]));
    }

    pub(crate) async fn run(&self, script: &str) -> Value {
        self.run_with(script, vec![]).await
    }

    pub(crate) async fn run_with(&self, script: &str, arguments: Vec<Value>) -> Value {
        let ran = self.client.execute(script, arguments).await;
        ran.unwrap_or_else(|error| panic!("{script}: {error}"))
    }

    /// Waits until an expression is true.
    pub(crate) async fn until(&self, expression: &str) {
        self.until_within(PATIENCE, expression).await;
    }

    /// Waits with another limit, for slow operations.
    pub(crate) async fn until_within(&self, patience: Duration, expression: &str) {
        let begin = Instant::now();
        while self.run(&format!("return Boolean({expression})")).await != json!(true) {
            if begin.elapsed() > patience {
                let text = self.text("body").await;
                panic!("{expression} did not become true; the page says: {text}");
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    pub(crate) async fn click(&self, selector: &str) {
        let found = self.client.find(Locator::Css(selector)).await;
        let found = found.unwrap_or_else(|error| panic!("{selector}: {error}"));
        found
            .click()
            .await
            .unwrap_or_else(|error| panic!("{selector}: {error}"));
    }

    /// Opens a pop-up, clicks into it, and closes it.
    pub(crate) async fn click_in_menu(&self, menu: &str, selector: &str) {
        let button = format!("#{menu} > summary");
        self.click(&button).await;
        self.click(selector).await;
        self.click(&button).await;
    }

    /// Clicks twice on the same place, as some users always do.
    pub(crate) async fn double_click(&self, selector: &str) {
        let element = self.client.find(Locator::Css(selector)).await.unwrap();
        let mut mouse = MouseActions::new("mouse".into()).then(PointerAction::MoveToElement {
            element,
            duration: None,
            x: 0.0,
            y: 0.0,
        });
        for _ in 0..2 {
            mouse = mouse
                .then(PointerAction::Down {
                    button: MOUSE_BUTTON_LEFT,
                })
                .then(PointerAction::Up {
                    button: MOUSE_BUTTON_LEFT,
                });
        }
        self.client.perform_actions(mouse).await.unwrap();
        self.client.release_actions().await.unwrap();
    }

    /// Chooses a file in the dialogue of the browser.
    pub(crate) async fn choose_file(&self, path: &Path) {
        let input = self.client.find(Locator::Css("#files")).await.unwrap();
        input.send_keys(path.to_str().unwrap()).await.unwrap();
    }

    /// Ends the server of the page.
    pub(crate) fn stop_the_server(&self) {
        self.server.lock().unwrap().0.stop();
    }

    /// Starts another server on the port and the folder of one that was ended; returns its address.
    pub(crate) async fn start_another_server(&self) -> String {
        let (_, port) = self
            .address
            .rsplit_once("/?")
            .unwrap()
            .0
            .rsplit_once(':')
            .unwrap();
        let begin = Instant::now();
        let server = loop {
            match bind(&self.folders[0], port.parse().unwrap()) {
                Ok(server) => break server,
                Err(error) if begin.elapsed() > PATIENCE => panic!("{error}"),
                // The port is free as soon as the other server has ended.
                Err(_) => tokio::time::sleep(Duration::from_millis(20)).await,
            }
        };
        let address = server.address();
        *self.server.lock().unwrap() = Running::start(server);
        address
    }

    pub(crate) async fn text(&self, selector: &str) -> String {
        let found = self.client.find(Locator::Css(selector)).await.unwrap();
        found.text().await.unwrap()
    }

    /// Types into a field and leaves it.
    pub(crate) async fn fill(&self, selector: &str, text: &str) {
        self.run_with(
            "const field = document.querySelector(arguments[0]); field.value = arguments[1]; \
             field.dispatchEvent(new Event('change', { bubbles: true }));",
            vec![json!(selector), json!(text)],
        )
        .await;
    }

    pub(crate) async fn press(&self, selector: &str, key: &str) {
        self.run_with(
            "document.querySelector(arguments[0]).dispatchEvent(new KeyboardEvent('keydown', { key: arguments[1], bubbles: true }));",
            vec![json!(selector), json!(key)],
        )
        .await;
    }

    /// Presses and releases a key of the keyboard, a code of WebDriver for one without a character.
    pub(crate) async fn type_key(&self, key: &str) {
        let value = key.chars().next().unwrap();
        let keys = KeyActions::new("keyboard".into())
            .then(KeyAction::Down { value })
            .then(KeyAction::Up { value });
        self.client.perform_actions(keys).await.unwrap();
    }

    /// Drops files onto the page, as a file manager does.
    pub(crate) async fn drop_files(&self, files: &[(&str, &str)]) {
        let files: Vec<Value> = files
            .iter()
            .map(|(name, text)| json!([name, text]))
            .collect();
        self.run_with(
            "const data = new DataTransfer(); \
             for (const [name, text] of arguments[0]) data.items.add(new File([text], name)); \
             document.getElementById('drop').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));",
            vec![json!(files)],
        )
        .await;
    }

    /// Drops a binary file.
    pub(crate) async fn drop_bytes(&self, name: &str, bytes: &[u8]) {
        self.run_with(
            "const data = new DataTransfer(); \
             data.items.add(new File([new Uint8Array(arguments[1])], arguments[0])); \
             document.getElementById('drop').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));",
            vec![json!(name), json!(bytes)],
        )
        .await;
    }

    /// Opens the example of practice rig 01, which has two logs.
    pub(crate) async fn open_example(&self) {
        self.click("[data-example='practice-01']").await;
        self.until("document.querySelectorAll('.log').length === 2")
            .await;
    }

    /// Opens the page of a log's comparison, and waits for its end.
    pub(crate) async fn compare(&self, log: &str) {
        self.click(&format!("[data-name=\"{log}\"] .compare")).await;
        self.until("document.body.dataset.ready === 'compare'")
            .await;
    }

    /// Saves an image of the whole page.
    pub(crate) async fn picture(&self, name: &str) {
        let height = self
            .run("return document.documentElement.scrollHeight")
            .await;
        let height = height.as_u64().unwrap().clamp(600, 4000) as u32;
        self.client
            .set_window_size(1280, height + 150)
            .await
            .unwrap();
        tokio::time::sleep(Duration::from_millis(300)).await;
        let png = self.client.screenshot().await.unwrap();
        self.client.set_window_size(1280, 1000).await.unwrap();
        keep(name, &png);
    }

    /// Waits until the browser has drawn twice, so that observers of sizes have acted.
    pub(crate) async fn draw(&self) {
        let frames = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));";
        self.client.execute_async(frames, vec![]).await.unwrap();
    }

    /// Saves an image of the visible part of the page.
    pub(crate) async fn picture_of_window(&self, name: &str) {
        keep(name, &self.client.screenshot().await.unwrap());
    }

    /// Saves an image of a part of the page.
    pub(crate) async fn picture_of(&self, selector: &str, name: &str) {
        let part = self.client.find(Locator::Css(selector)).await.unwrap();
        keep(name, &part.screenshot().await.unwrap());
    }
}

fn keep(name: &str, png: &[u8]) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join(format!("{name}.png")), png).unwrap();
}

async fn connect(port: u16, profile: &TempDir) -> Client {
    let capabilities = json!({
        "browserName": "chrome",
        "goog:chromeOptions": {
            "args": [
                "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
                "--disable-component-update", "--disable-quic", "--disable-sync", "--no-first-run",
                format!("--user-data-dir={}", profile.path().display()),
            ]
        }
    });
    let Value::Object(capabilities) = capabilities else {
        unreachable!("it is written as an object above")
    };
    let begin = Instant::now();
    loop {
        let mut builder = ClientBuilder::new(HttpConnector::new());
        builder.capabilities(capabilities.clone());
        match builder.connect(&format!("http://127.0.0.1:{port}")).await {
            Ok(client) => return client,
            Err(error) if begin.elapsed() > PATIENCE => {
                panic!("{error}; sudo apt-get install -y chromium chromium-driver")
            }
            Err(_) => tokio::time::sleep(Duration::from_millis(50)).await,
        }
    }
}
