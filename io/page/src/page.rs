//! The page: its program, its style and the data in one text.

use std::sync::LazyLock;

use super::document::Document;
use super::frames::KeptFrames;
use super::live::LivePage;
use super::pack::pack_text;
use super::replay::Replay;
use isosheet_files::DataError;
use isosheet_formats::MotionFrames;

/// The page without title, style, licences, data and program, which belong at the markers, in this order.
const TEMPLATE: &str = include_str!("../view/page.html");
const STYLE: &str = include_str!("../view/dist/view.css");
const LICENCES: &str = include_str!("../view/dist/LICENSES.txt");
const PROGRAM: &str = include_str!("../view/dist/view.js");

/// The program as it is in a page.
static PACKED_PROGRAM: LazyLock<String> = LazyLock::new(|| pack_text(PROGRAM));

/// The size of a page without data.
fn shell_size() -> usize {
    TEMPLATE.len() + STYLE.len() + LICENCES.len() + PACKED_PROGRAM.len()
}

/// How a page is made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageOptions {
    /// The largest size of a page, in bytes; default 8 000 000, which browsers open in about a second and
    /// which passes as an attachment. Of a run that needs more, every second, fourth, ... frame is kept, and
    /// the last one. The page says so.
    pub budget: usize,
}

impl Default for PageOptions {
    fn default() -> Self {
        Self { budget: 8_000_000 }
    }
}

impl PageOptions {
    /// Checks that the budget has room for the program of the page.
    ///
    /// # Errors
    /// [`DataError`].
    pub fn validate(&self) -> Result<(), DataError> {
        let least = shell_size();
        if self.budget < least {
            let message = format!(
                "the budget is {} bytes, but the program of the page alone has {least} bytes",
                self.budget
            );
            return Err(DataError::new(message, "raise the budget"));
        }
        Ok(())
    }
}

impl Replay {
    /// The page as a text, with the default [`PageOptions`].
    ///
    /// # Errors
    /// See [`Self::to_html_with`].
    pub fn to_html(&self) -> Result<String, DataError> {
        self.to_html_with(&PageOptions::default())
    }

    /// The page as a text: one file that needs no other and no connection.
    ///
    /// # Errors
    /// [`DataError`] for a replay or options that are not valid, and when a page with the first and the last
    /// frame alone exceeds the budget.
    pub fn to_html_with(&self, options: &PageOptions) -> Result<String, DataError> {
        self.check_lengths()?;
        self.page_of(self, options)
    }

    /// The page of some frames, which have as many positions as the rest shape and values of all fields; what
    /// this replay has of them is not used. One frame is in memory at a time.
    pub fn page_of<M: MotionFrames<Error: From<DataError>>>(
        &self,
        frames: &M,
        options: &PageOptions,
    ) -> Result<String, M::Error> {
        options.validate()?;
        self.check_frames(frames)?;
        let mut stride = 1;
        loop {
            let kept = KeptFrames {
                frames: self.times.len(),
                stride,
            };
            let count = kept.numbers().count();
            // Of the page with the fewest frames an error says how long it is.
            let most = if count <= 2 {
                usize::MAX
            } else {
                options.budget
            };
            let document = Document::new(self, frames, kept, most)?;
            let page = document.map(|d| fill(&self.title, "", &d.to_json()));
            match page {
                Some(page) if page.len() <= options.budget => return Ok(page),
                Some(page) if count <= 2 => {
                    let message = format!(
                        "the page has {} bytes with {count} frames left, but the budget is {} bytes",
                        page.len(),
                        options.budget
                    );
                    let remedy = "raise the budget, or leave out fields or series";
                    return Err(DataError::new(message, remedy).into());
                }
                _ => stride *= 2,
            }
        }
    }

    /// The page of a run that goes on, which gets all states but the first from the server that it comes
    /// from.
    ///
    /// # Errors
    /// [`DataError`] for a replay that is not valid.
    pub fn to_live_html(&self, live: &LivePage) -> Result<String, DataError> {
        self.validate()?;
        let nonce = match live.nonce.as_str() {
            "" => String::new(),
            nonce => format!(" nonce=\"{}\"", escape(nonce)),
        };
        let kept = KeptFrames {
            frames: self.times.len(),
            stride: 1,
        };
        let document = Document::new(self, self, kept, usize::MAX)?;
        let document = document.expect("no length is too long").live(live);
        Ok(fill(&self.title, &nonce, &document.to_json()))
    }
}

/// Fills the template. Texts that are filled in are not searched for markers.
fn fill(title: &str, nonce: &str, data: &str) -> String {
    let mut page = String::with_capacity(shell_size() + title.len() + data.len());
    let mut rest = TEMPLATE;
    for (marker, text) in [
        ("{title}", escape(title).as_str()),
        ("{style}", STYLE),
        ("{licences}", &escape(LICENCES)),
        ("{data}", data),
        ("{program}", &PACKED_PROGRAM),
        ("{nonce}", nonce),
    ] {
        let (before, after) = rest
            .split_once(marker)
            .expect("the template has the markers");
        page.push_str(before);
        page.push_str(text);
        rest = after;
    }
    page.push_str(rest);
    page
}

/// A text in HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
