//! What is written for papers: `dynamics --latex`, `laws --latex`, `report --tex`.

use crate::support::{ARM, Place};
use std::fs;
use std::process::{Command, Stdio};

/// What must stay text in a document.
const BAD: &str = "100 % of \\\\input{x} & $y$ #1 ~^_ α₁ Ć 中";

/// Braces, environments and `$` come in pairs, and a `pdflatex`, where one is there, makes pages of it.
fn compiles(place: &Place, file: &str) {
    let text = place.read(file);
    let plain = ["\\\\", "\\{", "\\}", "\\$", "\\%"].iter().fold(text.clone(), |text, taken| text.replace(taken, ""));
    let (mut depth, mut dollars) = (0_i32, 0);
    for c in plain.lines().map(|line| line.split('%').next().unwrap()).flat_map(str::chars) {
        depth += i32::from(c == '{') - i32::from(c == '}');
        dollars += i32::from(c == '$');
        assert!(depth >= 0, "{file}: a brace closes what none has opened");
    }
    assert_eq!((depth, dollars % 2), (0, 0), "{file}");
    let environments = |word: &str| {
        let mut names: Vec<&str> = plain.split(word).skip(1).map(|rest| rest.split('}').next().unwrap()).collect();
        names.sort_unstable();
        names
    };
    assert_eq!(environments("\\begin{"), environments("\\end{"), "{file}");
    let path = place.path(file);
    let compiled = Command::new("pdflatex")
        .args(["-interaction=nonstopmode", "-halt-on-error"])
        .arg(path.file_name().unwrap())
        .current_dir(path.parent().unwrap())
        .stdout(Stdio::null())
        .status();
    if let Ok(status) = compiled {
        let log = fs::read(path.with_extension("log")).unwrap_or_default();
        assert!(status.success(), "{file}: {}", String::from_utf8_lossy(&log));
    }
}

#[test]
fn equations_of_motion_have_matrices_with_units() {
    let place = Place::with(&ARM.replacen("Damped arm", BAD, 1));
    let tex = place.done(&["dynamics", "arm.toml", "--at", "0.2", "--latex"]).stdout;
    place.write("arm.tex", &tex);
    compiles(&place, "arm.tex");
    // A turn and a shift: entries of three units.
    for part in [
        "a_{ac}(q)\\,\\ddot q_a + \\Gamma_{ab,c}(q)\\,\\dot q_a\\,\\dot q_b = Q^{\\mathrm{g}}_c + \\sum_e Q^{e}_c",
        "\\mathrm{kg}\\,\\mathrm{m}^{2} & \\mathrm{kg}\\,\\mathrm{m} \\\\\n\\mathrm{kg}\\,\\mathrm{m} & \\mathrm{kg}",
        "\\textbf{damper}",
        "100 \\% of \\textbackslash{}input\\{x\\} \\& \\$y\\$ \\#1",
        "\\texttt{U+4E2D}",
        "These terms close to $",
    ] {
        assert!(tex.contains(part), "{part}\n{tex}");
    }
    // The numbers are those of --json, with five digits.
    let json = place.done(&["dynamics", "arm.toml", "--at", "0.2", "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let inertia = json["M"][0][0].as_f64().unwrap();
    let (_, matrix) = tex.split_once("(a_{ab}) = \\begin{bmatrix}\n").unwrap();
    let shown: f64 = matrix.split(" & ").next().unwrap().parse().unwrap();
    assert!((shown / inertia - 1.0).abs() < 5e-5, "{shown} {inertia}");
    let both = place.springpot(&["dynamics", "arm.toml", "--at", "0.2", "--latex", "--json"]);
    both.ends(2, &["--latex", "--json"]);
}

#[test]
fn every_law_has_its_formula() {
    let place = Place::new();
    let tex = place.done(&["laws", "--latex"]).stdout;
    place.write("laws.tex", &tex);
    compiles(&place, "laws.tex");
    let all: serde_json::Value = serde_json::from_str(&place.done(&["laws", "--json"]).stdout).unwrap();
    let all = all.as_array().unwrap();
    assert_eq!(tex.matches("\\subsection*{").count(), all.len());
    assert_eq!(tex.matches("Source: ").count(), all.len());
    let one = place.done(&["laws", "zener", "--latex"]).stdout;
    assert!(one.contains("$\\displaystyle F + \\left(\\frac{c}{k_{m}}\\right)\\, {F}'"), "{one}");
    assert!(one.contains("$k_{m}$ & $\\mathrm{N}/\\mathrm{m}$ & "), "{one}");
    place.springpot(&["laws", "zener", "--latex", "--json"]).ends(2, &["--latex"]);
}

#[test]
fn a_report_comes_with_its_pictures() {
    let figure = "[[figure]]\nname = \"force\"\nx = \"t\"\ny = \"damper.force\"\nformats = [\"svg\", \"pdf\"]\n";
    let place = Place::with(&format!("{}{figure}", ARM.replacen("Damped arm", BAD, 1)));
    place.done(&["run", "arm.toml", "--out", "o"]);
    let ended = place.done(&["report", "o", "--tex"]);
    assert_eq!(ended.stdout.trim_end(), "o/report.tex");
    let tex = place.read("o/report.tex");
    compiles(&place, "o/report.tex");
    let included = tex.matches("\\includegraphics").count();
    let pictures = place.files("o").into_iter().filter(|file| file.contains("report-figures/")).count();
    assert!(included >= 3 && pictures == included, "{included} {pictures}");
    let of_run = fs::read(place.path("o/figures/force.pdf")).unwrap();
    assert_eq!(fs::read(place.path("o/report-figures/figure-1.pdf")).unwrap(), of_run);
    for part in ["\\subsection*{Energy}", "Source of the law: ", "springpot run arm.toml"] {
        assert!(tex.contains(part), "{part}\n{tex}");
    }
    place.done(&["report", "o", "o", "--tex", "--out", "both.tex"]);
    compiles(&place, "both.tex");
    place.springpot(&["report", "o", "--tex", "--out", "two words.tex"]).ends(2, &["plain names"]);
    // The next run takes it away with its pictures, and a file of somebody else stays.
    place.write("o/report-figures/notes.txt", "mine");
    place.done(&["run", "arm.toml", "--out", "o"]);
    let left: Vec<String> = place
        .files("o")
        .into_iter()
        .filter(|file| file.contains("report"))
        .filter(|file| !file.ends_with('/'))
        .collect();
    assert!(left.iter().all(|file| !file.ends_with("report.tex") && !file.contains("figure-")), "{left:?}");
    assert_eq!(place.read("o/report-figures/notes.txt"), "mine");
}
