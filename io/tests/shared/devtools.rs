//! A browser without a window that is used as people do: by its pointer and its keys. It is driven by the
//! `DevTools` protocol over pipes, so that its own input handling is tested, too.

use crate::headless::browser;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long a page may take to come to a state: some milliseconds suffice on an idle machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// A browser with a page.
pub(crate) struct Driven {
    child: Child,
    commands: File,
    answers: BufReader<File>,
    session: Option<String>,
    next: u64,
    _folder: tempfile::TempDir,
    address: String,
}

/// Where the pointer is and what it does.
#[derive(Clone, Copy)]
pub(crate) enum Pointer {
    Press,
    /// With the button pressed.
    Drag,
    Release,
    /// Without a button.
    #[allow(dead_code, reason = "not every test binary looks for something")]
    Move,
}

impl Driven {
    /// Opens a page in a browser; `None` where none is installed.
    #[allow(dead_code, reason = "not every test binary opens a page of its own")]
    pub(crate) fn open(page: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("page.html");
        std::fs::write(&file, page).unwrap();
        Self::start(folder, address_of(&file))
    }

    /// Opens an address in a browser; `None` where none is installed.
    #[allow(dead_code, reason = "not every test binary has a server")]
    pub(crate) fn visit(address: &str) -> Option<Self> {
        Self::start(tempfile::tempdir().unwrap(), address.to_owned())
    }

    fn start(folder: tempfile::TempDir, address: String) -> Option<Self> {
        let browser = browser()?;
        let path = |name: &str| folder.path().join(name);
        let pipes = Command::new("mkfifo")
            .args([path("in"), path("out")])
            .status();
        assert!(pipes.unwrap().success());
        // The browser reads commands from the file descriptor 3 and writes answers to 4.
        let line = "exec \"$1\" --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader \
                    --window-size=1200,800 --remote-debugging-pipe \"--user-data-dir=$2/profile\" about:blank \
                    3<\"$2/in\" 4>\"$2/out\"";
        let child = Command::new("sh")
            .args(["-c", line, "sh", browser])
            .arg(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let commands = File::options().write(true).open(path("in")).unwrap();
        let answers = BufReader::new(File::open(path("out")).unwrap());
        let mut driven = Self {
            child,
            commands,
            answers,
            session: None,
            next: 1,
            _folder: folder,
            address,
        };
        let target = driven.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = driven.call("Target.attachToTarget", attach);
        driven.session = session["sessionId"].as_str().map(str::to_owned);
        driven.go("");
        Some(driven)
    }

    /// Loads the page anew, with a fragment such as `#frame=3`.
    pub(crate) fn go(&mut self, fragment: &str) {
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        let url = format!("{}{fragment}", self.address);
        self.call("Page.navigate", json!({ "url": url }));
        let shown = "document.getElementById('message')?.hidden === true";
        self.wait_for(shown);
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        let id = self.next;
        self.next += 1;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        write!(self.commands, "{message}\0").unwrap();
        loop {
            let mut bytes = Vec::new();
            let count = self.answers.read_until(0, &mut bytes).unwrap();
            assert!(count > 0, "the browser ended at {method}");
            bytes.pop();
            let answer: Value = serde_json::from_slice(&bytes).unwrap();
            if answer["id"] == json!(id) {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
        }
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", parameters);
        let exception = &answer["exceptionDetails"];
        assert!(exception.is_null(), "{expression}: {exception}");
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub(crate) fn wait_for(&mut self, expression: &str) {
        let begun = Instant::now();
        while self.value(expression) != json!(true) {
            assert!(begun.elapsed() < PATIENCE, "never true: {expression}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Clicks in the middle of an element.
    pub(crate) fn click(&mut self, id: &str) {
        let [x, y] = self.middle(id);
        self.pointer(Pointer::Press, [x, y]);
        self.pointer(Pointer::Release, [x, y]);
    }

    /// Drags from the middle of an element by some pixels.
    #[allow(dead_code, reason = "not every test binary drags an element")]
    pub(crate) fn drag(&mut self, id: &str, by: [f64; 2]) {
        let [x, y] = self.middle(id);
        self.pointer(Pointer::Press, [x, y]);
        for part in [0.25, 0.5, 0.75, 1.0] {
            self.pointer(Pointer::Drag, [x + part * by[0], y + part * by[1]]);
        }
        self.pointer(Pointer::Release, [x + by[0], y + by[1]]);
    }

    fn middle(&mut self, id: &str) -> [f64; 2] {
        let find = format!(
            "(() => {{ const e = document.getElementById('{id}'); e.scrollIntoView({{ block: 'nearest' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let place = self.value(&find);
        [0, 1].map(|k| place[k].as_f64().expect("a place"))
    }

    /// Does something with the pointer at a place, in pixels.
    pub(crate) fn pointer(&mut self, what: Pointer, [x, y]: [f64; 2]) {
        let (kind, button, buttons) = match what {
            Pointer::Press => ("mousePressed", "left", 1),
            Pointer::Drag => ("mouseMoved", "left", 1),
            Pointer::Release => ("mouseReleased", "left", 1),
            Pointer::Move => ("mouseMoved", "none", 0),
        };
        let parameters = json!({
            "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1,
        });
        self.call("Input.dispatchMouseEvent", parameters);
    }

    /// The picture of the page, as a PNG file.
    #[allow(dead_code, reason = "for a look at what a test sees")]
    pub(crate) fn picture(&mut self) -> Vec<u8> {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        STANDARD.decode(answer["data"].as_str().unwrap()).unwrap()
    }

    /// Presses a key and lets it go. Space has the name `" "`.
    pub(crate) fn press(&mut self, key: &str) {
        let (code, number, text) = match key {
            " " => ("Space", 32, " "),
            "Tab" => ("Tab", 9, ""),
            "Enter" => ("Enter", 13, "\r"),
            "End" => ("End", 35, ""),
            "Home" => ("Home", 36, ""),
            "ArrowLeft" => ("ArrowLeft", 37, ""),
            "ArrowRight" => ("ArrowRight", 39, ""),
            "ArrowDown" => ("ArrowDown", 40, ""),
            other => panic!("the number of the key {other} is not known"),
        };
        for kind in ["keyDown", "keyUp"] {
            let mut parameters =
                json!({ "type": kind, "key": key, "code": code, "windowsVirtualKeyCode": number });
            if kind == "keyDown" && !text.is_empty() {
                parameters["text"] = json!(text);
            }
            self.call("Input.dispatchKeyEvent", parameters);
        }
    }
}

impl Drop for Driven {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn address_of(path: &Path) -> String {
    format!("file://{}", path.display())
}
