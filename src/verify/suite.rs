//! Cases: what they are, which are run, and running them side by side.

use super::figure::Figure;
use rayon::prelude::*;

/// What runs a case; the error says why it came to no figures.
pub type Run = Box<dyn Fn() -> Result<Vec<Figure>, String> + Send + Sync>;

/// How much is run: each form contains the ones before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// What CI runs: all cases together take less than 30 s of one processor.
    Short,
    /// The manual: up to half an hour of one processor.
    Full,
    /// With cases of many minutes each.
    Complete,
}

impl Form {
    /// The short form, or else the full one.
    pub fn short_if(short: bool) -> Self {
        if short { Self::Short } else { Self::Full }
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Short => "short",
            Self::Full => "full",
            Self::Complete => "complete",
        }
    }
}

/// A verification case.
pub struct Case {
    /// Name on the command line.
    pub name: String,
    /// What is modelled and what is checked, one sentence.
    pub about: &'static str,
    /// The smallest form that it belongs to.
    pub form: Form,
    /// Computes its figures.
    pub run: Run,
}

impl Case {
    /// A case of the short form.
    pub fn short(
        name: impl Into<String>,
        about: &'static str,
        run: impl Fn() -> Result<Vec<Figure>, String> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), about, form: Form::Short, run: Box::new(run) }
    }

    /// A case of the full and the complete form.
    pub fn long(
        name: impl Into<String>,
        about: &'static str,
        run: impl Fn() -> Result<Vec<Figure>, String> + Send + Sync + 'static,
    ) -> Self {
        Self { form: Form::Full, ..Self::short(name, about, run) }
    }

    /// A case of the complete form only.
    pub fn complete(
        name: impl Into<String>,
        about: &'static str,
        run: impl Fn() -> Result<Vec<Figure>, String> + Send + Sync + 'static,
    ) -> Self {
        Self { form: Form::Complete, ..Self::short(name, about, run) }
    }

    /// Its figures, with its name in them.
    pub fn figures(&self) -> Result<Vec<Figure>, Failed> {
        let failed = |message: String| Failed { case: self.name.clone(), message };
        let mut figures = (self.run)().map_err(failed)?;
        figures.iter_mut().for_each(|f| f.case.clone_from(&self.name));
        Ok(figures)
    }
}

/// A case that came to no figures.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("case {case}: {message}")]
pub struct Failed {
    /// Its name.
    pub case: String,
    /// Why.
    pub message: String,
}

/// The cases of a form; with `name` those called so, and those of the short and full form (or the complete one, if that is asked for) whose
/// name begins so.
///
/// # Errors
/// If no case has that name.
pub fn select(cases: Vec<Case>, form: Form, name: Option<&str>) -> Result<Vec<Case>, String> {
    let Some(name) = name else {
        return Ok(cases.into_iter().filter(|c| c.form <= form).collect());
    };
    let names: Vec<String> = cases.iter().map(|c| c.name.clone()).collect();
    let wide = form.max(Form::Full);
    let chosen: Vec<Case> =
        cases.into_iter().filter(|c| c.name == name || c.form <= wide && c.name.starts_with(name)).collect();
    if chosen.is_empty() {
        return Err(format!("no case begins with `{name}`; there are: {}", names.join(", ")));
    }
    Ok(chosen)
}

/// Runs cases side by side in the current rayon pool; results in the order of the cases. `done` is called after each with its name.
pub fn run(cases: &[Case], done: &(dyn Fn(&str) + Sync)) -> Vec<Result<Vec<Figure>, Failed>> {
    let one = |case: &Case| {
        let figures = case.figures();
        done(&case.name);
        figures
    };
    cases.par_iter().with_max_len(1).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> Vec<Case> {
        let figure = || Ok(vec![Figure::relative("x", "-", [1.0, 1.0], 0.0, "s")]);
        vec![
            Case::short("a", "", figure),
            Case::long("a-fine", "", figure),
            Case::short("b", "", || Err("no state".into())),
            Case::complete("b-all", "", figure),
        ]
    }

    #[test]
    fn cases_are_chosen_by_form_and_by_name() {
        let names = |form, name| {
            select(cases(), form, name).map(|c| c.into_iter().map(|c| c.name).collect::<Vec<_>>())
        };
        assert_eq!(names(Form::Short, None).unwrap(), ["a", "b"]);
        assert_eq!(names(Form::Full, None).unwrap(), ["a", "a-fine", "b"]);
        assert_eq!(names(Form::Complete, None).unwrap(), ["a", "a-fine", "b", "b-all"]);
        assert_eq!(names(Form::Short, Some("a-")).unwrap(), ["a-fine"]);
        assert_eq!(names(Form::Full, Some("b")).unwrap(), ["b"]);
        assert_eq!(names(Form::Short, Some("b-all")).unwrap(), ["b-all"]);
        assert!(names(Form::Full, Some("c")).unwrap_err().contains("a-fine"));
    }

    #[test]
    fn results_keep_the_order_and_name_what_failed() {
        let results = run(&cases(), &|_| ());
        assert_eq!(results[1].as_ref().unwrap()[0].case, "a-fine");
        assert_eq!(results[2].as_ref().unwrap_err().to_string(), "case b: no state");
    }
}
