//! The words of a page: title and verdict above the drawing, sentences below.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle};
use super::colour;
use super::layout::{MARGIN, PAGE_WIDTH};
use super::text;
use super::views::{GREY, INK};

/// Height of the title's type, mm.
const TITLE_TYPE: f64 = 6.0;
/// Height of the sentences' type, mm.
const SENTENCE_TYPE: f64 = 3.2;
/// Distance of the sentences' base lines, mm.
const SENTENCE_LINE: f64 = 4.8;
/// Sentences beyond this number of lines are cut: a page, not a book.
const MOST_LINES: usize = 60;

/// What a page says besides its drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words<'a> {
    /// Title.
    pub title: &'a str,
    /// Unit of every length.
    pub units: &'a str,
    /// Verdict, a word or a short phrase.
    pub verdict: &'a str,
    /// Whether the verdict is good.
    pub good: bool,
    /// Sentences.
    pub summary: &'a [String],
}

/// Title and verdict; returns the last base line, mm.
pub(super) fn heading(canvas: &mut Canvas, words: &Words<'_>) -> f64 {
    let room = PAGE_WIDTH - 2.0 * MARGIN;
    let mut y = MARGIN + TITLE_TYPE - 1.5;
    let style = TextStyle {
        size: TITLE_TYPE,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    // Bold type runs a tenth wider than the estimate.
    canvas.text(
        [MARGIN, y],
        style,
        &text::clip(words.title, TITLE_TYPE, room * 0.9),
    );
    y += 6.5;
    let colour = if words.good {
        "#1a7f4b"
    } else {
        colour::ABOVE_LIMIT
    };
    canvas.circle(
        [MARGIN + 1.4, y - 1.25],
        1.4,
        colour,
        Stroke { colour, width: 0.1 },
    );
    let verdict = format!(
        "{} · lengths in {}",
        words.verdict.replace('_', " "),
        words.units
    );
    let style = TextStyle {
        size: 3.6,
        colour: GREY,
        anchor: Anchor::Start,
        bold: false,
    };
    canvas.text(
        [MARGIN + 4.4, y],
        style,
        &text::clip(&verdict, 3.6, room - 4.4),
    );
    y
}

/// The sentences, wrapped; returns the base line after the last, mm.
pub(super) fn sentences(canvas: &mut Canvas, words: &Words<'_>, top: f64) -> f64 {
    let style = TextStyle {
        size: SENTENCE_TYPE,
        colour: INK,
        anchor: Anchor::Start,
        bold: false,
    };
    let room = PAGE_WIDTH - 2.0 * MARGIN;
    let lines = words
        .summary
        .iter()
        .flat_map(|s| text::wrap(s, SENTENCE_TYPE, room));
    let mut y = top;
    for line in lines.take(MOST_LINES) {
        canvas.text([MARGIN, y], style, &line);
        y += SENTENCE_LINE;
    }
    y
}

/// Height of a page whose sentences end at this base line, mm.
pub(super) fn height(after_sentences: f64) -> f64 {
    (after_sentences + MARGIN - SENTENCE_LINE).ceil()
}
