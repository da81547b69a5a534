//! `table.csv`: one row a run, for spreadsheets.

use super::Report;

/// RFC 4180, header first, empty cells for what was not measured.
pub fn to_csv(report: &Report) -> String {
    const HEADER: &str = "scene,role,technique,params,status,recommended,pareto,rmse,rmse_floor,distinguishable,rel_mse,psnr,ssim,flip,\
                          mean_ratio,bias,noise,off_border_mismatch,border_px,gpu_ms,gpu_ms_p95,cpu_ms,memory_bytes,rays,flicker,lag,ghost";
    let mut out = format!("{HEADER}\n");
    for (index, run) in report.runs.iter().enumerate() {
        let decision = report.decisions.iter().find(|d| d.scene == run.scene && d.role == run.role);
        let error = run.error.as_ref();
        let cost = run.cost.as_ref();
        let params = run.params.iter().map(|(k, v)| format!("{k}={}", v.as_str().map_or_else(|| v.to_string(), str::to_owned)));
        let cells = [
            run.scene.clone(),
            run.role.clone(),
            run.technique.clone(),
            params.collect::<Vec<_>>().join(","),
            run.status.clone(),
            decision.is_some_and(|d| d.recommended == Some(index)).to_string(),
            decision.is_some_and(|d| d.pareto.contains(&index)).to_string(),
            cell(error.map(|e| e.image.rmse)),
            cell(error.and_then(|e| e.image.rmse_floor)),
            cell(error.and_then(|e| e.image.distinguishable)),
            cell(error.map(|e| e.image.rel_mse)),
            cell(error.and_then(|e| e.image.psnr)),
            cell(error.and_then(|e| e.image.ssim)),
            cell(error.map(|e| e.image.flip)),
            cell(error.and_then(|e| e.image.mean_ratio)),
            cell(error.and_then(|e| e.bias)),
            cell(error.and_then(|e| e.noise)),
            cell(error.and_then(|e| e.off_border_mismatch)),
            cell(error.and_then(|e| e.border_px)),
            cell(cost.and_then(|c| c.gpu_ms)),
            cell(cost.and_then(|c| c.gpu_ms_p95)),
            cell(cost.map(|c| c.cpu_ms)),
            cell(cost.map(|c| c.memory_bytes)),
            cell(cost.map(|c| c.rays)),
            cell(run.temporal.flicker),
            cell(run.temporal.lag),
            cell(run.temporal.ghost),
        ];
        out += &(cells.map(|c| quoted(&c)).join(",") + "\n");
    }
    out
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |v| v.to_string())
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example::report;

    #[test]
    fn every_row_has_as_many_cells_as_the_header() {
        let mut report = report();
        report.runs[0].scene = "a \"scene\", quoted".into();
        let csv = to_csv(&report);
        let cells = |line: &str| {
            let mut quoted = false;
            1 + line
                .chars()
                .filter(|&c| {
                    quoted ^= c == '"';
                    c == ',' && !quoted
                })
                .count()
        };
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 1 + report.runs.len());
        lines.iter().for_each(|line| assert_eq!(cells(line), cells(lines[0]), "{line}"));
        assert!(lines[1].starts_with("\"a \"\"scene\"\", quoted\","));
    }
}
