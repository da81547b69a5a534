//! From numbers to advice: which technique to use for a budget, and how sure that is.
//!
//! Two runs whose errors differ by less than the reference's noise and the seeds allow are a tie, and a tie is decided by cost. The
//! report says which of the two it was.

use kajo_image_metrics::MseDifference;
use serde::Serialize;

/// Standard errors beyond which a difference counts.
pub const SIGMAS: f64 = 3.0;

/// A run as the decision sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Index into [`Report::runs`](super::Report::runs).
    pub run: usize,
    /// For the sentence.
    pub label: String,
    /// Error of the role's image.
    pub mse: f64,
    /// Cost of a frame, ms.
    pub ms: f64,
    /// False when the error cannot be told from the reference's noise.
    pub distinguishable: bool,
}

/// How sure a recommendation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Certainty {
    /// Every other affordable run is worse by more than [`SIGMAS`] standard errors.
    Clear,
    /// Others are as good as can be told; this is the cheapest of them.
    Tie,
    /// Nothing else is affordable.
    OnlyOne,
    /// Nothing is.
    None,
}

/// The advice for one role on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// As the user named it.
    pub scene: String,
    /// Id of the role.
    pub role: String,
    /// Most that a frame may cost, ms.
    pub budget_ms: Option<f64>,
    /// Index into the runs.
    pub recommended: Option<usize>,
    /// How sure.
    pub certainty: Certainty,
    /// Standard errors between it and the next affordable run that is not a tie; `null` when there is none or the distance is exact.
    pub sigmas: Option<f64>,
    /// Runs that cannot be told from it.
    pub ties: Vec<usize>,
    /// Runs that no other run beats in both error and cost, cheapest first.
    pub pareto: Vec<usize>,
    /// The advice in words.
    pub sentence: String,
}

/// Recommends the lowest error among the candidates within the budget; among ties with it, the lowest cost.
///
/// `difference(a, b)`: MSE of candidate a minus that of b, with its standard error.
pub fn decide(
    scene: &str,
    role: &str,
    candidates: &[Candidate],
    budget_ms: Option<f64>,
    difference: impl Fn(usize, usize) -> MseDifference,
) -> Decision {
    let affordable: Vec<usize> = (0..candidates.len()).filter(|&i| budget_ms.is_none_or(|b| candidates[i].ms <= b)).collect();
    let decision = |recommended, certainty, sigmas, ties, sentence| Decision {
        scene: scene.to_owned(),
        role: role.to_owned(),
        budget_ms,
        recommended,
        certainty,
        sigmas,
        ties,
        pareto: pareto_front(candidates),
        sentence,
    };
    let Some(&best) = affordable.iter().min_by(|&&a, &&b| candidates[a].mse.total_cmp(&candidates[b].mse)) else {
        return decision(None, Certainty::None, None, vec![], nothing(candidates, budget_ms));
    };
    // Two exact techniques are a tie although the reference is exact too: 0 difference is 0 standard errors.
    let tie = |&&i: &&usize| i == best || difference(i, best).sigmas() < SIGMAS;
    let ties: Vec<usize> = affordable.iter().filter(tie).copied().collect();
    let chosen = *ties.iter().min_by(|&&a, &&b| candidates[a].ms.total_cmp(&candidates[b].ms)).expect("the best is a tie with itself");
    let others = || affordable.iter().filter(|i| !ties.contains(i));
    let next = others().min_by(|&&a, &&b| candidates[a].mse.total_cmp(&candidates[b].mse));
    let certainty = match (ties.len(), affordable.len()) {
        (_, 1) => Certainty::OnlyOne,
        (1, _) => Certainty::Clear,
        _ => Certainty::Tie,
    };
    let sigmas = next.map(|&n| difference(n, chosen).sigmas()).filter(|s| s.is_finite());
    let sentence = sentence(candidates, chosen, certainty, ties.len() - 1, next.copied(), budget_ms);
    let runs = |list: Vec<usize>| list.into_iter().filter(|&i| i != chosen).map(|i| candidates[i].run).collect();
    decision(Some(candidates[chosen].run), certainty, sigmas, runs(ties), sentence)
}

fn nothing(candidates: &[Candidate], budget_ms: Option<f64>) -> String {
    let cheapest = candidates.iter().min_by(|a, b| a.ms.total_cmp(&b.ms));
    match (cheapest, budget_ms) {
        (Some(c), Some(budget)) => {
            format!("Nothing fits {} ms; the cheapest, {}, takes {} ms.", short(budget), c.label, short(c.ms))
        }
        _ => "No technique could run here.".to_owned(),
    }
}

fn sentence(
    candidates: &[Candidate],
    chosen: usize,
    certainty: Certainty,
    ties: usize,
    next: Option<usize>,
    budget_ms: Option<f64>,
) -> String {
    let c = &candidates[chosen];
    let within = budget_ms.map_or_else(String::new, |b| format!(" within {} ms", short(b)));
    let error = if c.distinguishable {
        format!("RMSE {} at {} ms", short(c.mse.sqrt()), short(c.ms))
    } else {
        format!("no error that this reference can show, at {} ms", short(c.ms))
    };
    let mut text = match certainty {
        Certainty::OnlyOne => format!("Use {}: the only one{within}. It has {error}.", c.label),
        Certainty::Tie => format!(
            "Use {}: {error}. {ties} other{} as good as can be told{within} and cost more.",
            c.label,
            if ties == 1 { " is" } else { "s are" }
        ),
        _ => format!("Use {}: {error}, the lowest error{within}.", c.label),
    };
    if let Some(next) = next {
        let n = &candidates[next];
        let factor = (n.mse / c.mse).sqrt();
        let times = if factor.is_finite() { format!("{} times the error", short(factor)) } else { format!("RMSE {}", short(n.mse.sqrt())) };
        text += &format!(" The next, {}, has {times} at {} ms.", n.label, short(n.ms));
    }
    text
}

/// Runs that no other beats in both error and cost, cheapest first. Of equal runs the first stays.
pub fn pareto_front(candidates: &[Candidate]) -> Vec<usize> {
    let mut order: Vec<&Candidate> = candidates.iter().collect();
    order.sort_by(|a, b| a.ms.total_cmp(&b.ms).then(a.mse.total_cmp(&b.mse)));
    let mut lowest = f64::INFINITY;
    let mut front = Vec::new();
    for c in order {
        if c.mse < lowest {
            lowest = c.mse;
            front.push(c.run);
        }
    }
    front
}

/// Three significant digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    match digits {
        ..=0 => {
            let unit = 10f64.powi(-digits);
            format!("{}", (value / unit).round() * unit)
        }
        1..=6 => {
            let text = format!("{value:.*}", digits as usize);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(run: usize, mse: f64, ms: f64) -> Candidate {
        Candidate { run, label: format!("t/{run}"), mse, ms, distinguishable: true }
    }

    /// Differences with one standard error for all.
    fn with_error(candidates: &[Candidate], standard_error: f64) -> impl Fn(usize, usize) -> MseDifference + '_ {
        move |a, b| MseDifference { value: candidates[a].mse - candidates[b].mse, standard_error }
    }

    #[test]
    fn clear_winner_is_the_lowest_error_within_the_budget() {
        let c = [candidate(0, 0.04, 0.1), candidate(1, 0.01, 2.0), candidate(2, 0.0001, 9.0)];
        let d = decide("s", "r", &c, Some(5.0), with_error(&c, 1e-4));
        assert_eq!((d.recommended, d.certainty, d.ties.len()), (Some(1), Certainty::Clear, 0));
        assert!((d.sigmas.unwrap() - 300.0).abs() < 1e-6);
        assert_eq!(d.sentence, "Use t/1: RMSE 0.1 at 2 ms, the lowest error within 5 ms. The next, t/0, has 2 times the error at 0.1 ms.");
        assert_eq!(d.pareto, [0, 1, 2]);
        assert_eq!(decide("s", "r", &c, None, with_error(&c, 1e-4)).recommended, Some(2));
    }

    #[test]
    fn a_tie_is_decided_by_cost_and_said() {
        let c = [candidate(0, 0.0101, 1.0), candidate(1, 0.0100, 2.0), candidate(2, 0.04, 0.5)];
        let d = decide("s", "r", &c, None, with_error(&c, 1e-3));
        assert_eq!((d.recommended, d.certainty, d.ties.as_slice()), (Some(0), Certainty::Tie, [1].as_slice()));
        assert!(d.sentence.contains("1 other is as good as can be told"), "{}", d.sentence);
    }

    /// The planted fault: a decision that ignored the noise would choose the dearer run.
    #[test]
    fn without_noise_the_same_pair_is_not_a_tie() {
        let c = [candidate(0, 0.0101, 1.0), candidate(1, 0.0100, 2.0)];
        assert_eq!(decide("s", "r", &c, None, with_error(&c, 0.0)).recommended, Some(1));
    }

    #[test]
    fn two_exact_techniques_tie() {
        let c = [candidate(0, 0.0, 3.0), candidate(1, 0.0, 1.0), candidate(2, 0.01, 0.5)];
        let d = decide("s", "r", &c, None, with_error(&c, 0.0));
        assert_eq!((d.recommended, d.certainty, d.sigmas), (Some(1), Certainty::Tie, None));
        assert!(d.sentence.contains("t/2, has RMSE 0.1"), "{}", d.sentence);
    }

    #[test]
    fn nothing_affordable_names_the_cheapest_and_nothing_at_all_says_so() {
        let c = [candidate(0, 0.04, 4.0)];
        let d = decide("s", "r", &c, Some(1.0), with_error(&c, 0.0));
        assert_eq!((d.recommended, d.certainty), (None, Certainty::None));
        assert!(d.sentence.contains("the cheapest, t/0, takes 4 ms"), "{}", d.sentence);
        assert_eq!(decide("s", "r", &[], None, with_error(&[], 0.0)).sentence, "No technique could run here.");
        assert_eq!(decide("s", "r", &c, None, with_error(&c, 0.0)).certainty, Certainty::OnlyOne);
    }

    #[test]
    fn pareto_front_drops_what_is_beaten_in_both() {
        let c = [candidate(0, 0.04, 1.0), candidate(1, 0.05, 2.0), candidate(2, 0.01, 3.0), candidate(3, 0.01, 4.0)];
        assert_eq!(pareto_front(&c), [0, 2]);
    }

    #[test]
    fn numbers_have_three_digits() {
        let cases = [(0.0, "0"), (1234.4, "1230"), (99.96, "100"), (1.0, "1"), (0.012_345, "0.0123"), (3e-9, "3.00e-9"), (-2.5, "-2.5")];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }
}
