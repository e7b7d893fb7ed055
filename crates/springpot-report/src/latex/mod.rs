//! LaTeX that `pdflatex` alone compiles: text, quantities, tables and documents.
//!
//! Documents take `amsmath`, `array`, `geometry`, `graphicx` and `longtable`, which every LaTeX has, and the fonts of TeX. Characters that those
//! fonts lack are named by their number.

mod table;
mod text;

pub use table::{Cell, Column, table};
pub use text::{code, number, text, unit};

/// Stands at the head of every document.
pub const MARK: &str = "% Made by Springpot";

/// A whole document of this title, of text, and this body, of LaTeX.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "{MARK}; compile it with pdflatex.\n\
         \\documentclass[10pt,a4paper]{{article}}\n\
         \\usepackage[utf8]{{inputenc}}\n\
         \\usepackage[margin=20mm]{{geometry}}\n\
         \\usepackage{{amsmath,array,graphicx,longtable}}\n\
         \\setlength{{\\parindent}}{{0pt}}\n\
         \\setlength{{\\parskip}}{{6pt}}\n\
         \\setlength{{\\LTpre}}{{6pt}}\n\
         \\setlength{{\\LTpost}}{{6pt}}\n\
         \\setlength{{\\LTleft}}{{0pt}}\n\
         \\emergencystretch=3em\n\
         \\raggedbottom\n\
         \\begin{{document}}\n\
         \\section*{{{}}}\n\n\
         {body}\
         \\end{{document}}\n",
        text(title)
    )
}
