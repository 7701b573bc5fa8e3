//! A browser without a window, driven over a pipe by the `DevTools` protocol.

#![expect(
    clippy::indexing_slicing,
    reason = "a value of JSON is null where it has no such part"
)]

use std::{
    io::{BufRead as _, BufReader, Write as _},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, anyhow, bail};
use serde_json::{Value, json};

use crate::{
    machine::on_path,
    tools::{Tool, Toolbox},
};

/// Program of the fetched browser.
const FETCHED: &str = "chromium-headless-shell";

/// Names of Chromium and its relatives on a search path.
const PROGRAMS: [&str; 4] = [FETCHED, "chromium", "chromium-browser", "google-chrome"];

/// Longest time for one answer.
const PATIENCE: Duration = Duration::from_mins(1);

/// The page that is driven is the project's own, and root has no sandbox.
const FLAGS: [&str; 7] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--hide-scrollbars",
    "--no-first-run",
    "--remote-debugging-pipe",
    "about:blank",
];

/// Finds a browser on the search path, or else fetches one.
///
/// # Errors
/// [`Missing`](crate::missing::Missing) if there is none and none can be fetched.
pub(super) fn find(toolbox: &Toolbox<'_>) -> Result<PathBuf> {
    if let Some(program) = PROGRAMS.into_iter().find_map(on_path) {
        return Ok(program);
    }
    let tool = toolbox.provide(Tool::Browser)?;
    Ok(tool.program(FETCHED))
}

/// A browser with one page.
#[derive(Debug)]
pub(super) struct Browser {
    process: Child,
    commands: ChildStdin,
    answers: Receiver<Value>,
    session: Option<Value>,
    count: u64,
}

impl Browser {
    /// Starts a browser, with a directory for its files.
    ///
    /// # Errors
    /// An error if it does not start or answer.
    pub(super) fn start(program: &Path, profile: &Path) -> Result<Self> {
        let mut process = Command::new("sh")
            // The protocol's pipes are those with the numbers 3 and 4.
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null"])
            .arg(program)
            .arg(format!("--user-data-dir={}", profile.display()))
            .args(FLAGS)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("sh")?;
        let commands = process.stdin.take().context("pipe of the browser")?;
        let answers = process.stdout.take().context("pipe of the browser")?;
        let (sender, receiver) = mpsc::channel();
        thread::spawn(move || {
            for message in BufReader::new(answers).split(0) {
                let value = message
                    .ok()
                    .and_then(|text| serde_json::from_slice(&text).ok());
                if value.is_none_or(|value| sender.send(value).is_err()) {
                    return;
                }
            }
        });
        let mut browser = Self {
            process,
            commands,
            answers: receiver,
            session: None,
            count: 0,
        };
        browser.open()?;
        Ok(browser)
    }

    /// Opens another page, to which further commands go.
    ///
    /// # Errors
    /// An error if the browser refuses.
    pub(super) fn open(&mut self) -> Result<()> {
        self.session = None;
        let page = self.call("Target.createTarget", &json!({"url": "about:blank"}))?;
        let attach = json!({"targetId": page["targetId"], "flatten": true});
        let session = self.call("Target.attachToTarget", &attach)?;
        self.session = Some(session["sessionId"].clone());
        self.call("Page.enable", &json!({}))?;
        Ok(())
    }

    /// Loads a page, and waits until an expression is true in it.
    ///
    /// # Errors
    /// An error if it never is.
    pub(super) fn load(&mut self, address: &str, until: &str) -> Result<()> {
        self.call("Page.navigate", &json!({"url": address}))?;
        for _ in 0..600 {
            // Between two pages there is none to ask.
            if self.evaluate(until).is_ok_and(|answer| answer == true) {
                return Ok(());
            }
            thread::sleep(Duration::from_millis(50));
        }
        bail!("{address} does not come to {until}")
    }

    /// Returns the value of an expression in the page.
    ///
    /// # Errors
    /// An error that it throws.
    pub(super) fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let asked = json!({
            "expression": expression, "awaitPromise": true, "returnByValue": true,
        });
        let answer = self.call("Runtime.evaluate", &asked)?;
        if let Some(fault) = answer.get("exceptionDetails") {
            bail!("{}: {}", fault["text"], fault["exception"]["description"]);
        }
        Ok(answer["result"]["value"].clone())
    }

    /// Calls a method of the protocol.
    ///
    /// # Errors
    /// An error if the browser refuses or does not answer.
    pub(super) fn call(&mut self, method: &str, parameters: &Value) -> Result<Value> {
        self.count += 1;
        let mut message = json!({"id": self.count, "method": method, "params": parameters});
        if let (Some(session), Some(fields)) = (&self.session, message.as_object_mut()) {
            fields.insert("sessionId".to_owned(), session.clone());
        }
        write!(self.commands, "{message}\0").context("the browser has ended")?;
        self.commands.flush()?;
        loop {
            let answer = self.answers.recv_timeout(PATIENCE);
            let answer = answer.map_err(|_| anyhow!("the browser does not answer {method}"))?;
            if answer["id"] != self.count {
                continue;
            }
            if let Some(error) = answer.get("error") {
                bail!("{method}: {}", error["message"]);
            }
            return Ok(answer["result"].clone());
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
