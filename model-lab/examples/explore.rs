use plant_sim::PlantParameters;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    for rig in &args[1..] {
        let plant = PlantParameters::nominal();
        let read = |kind: &str| recording::csv::read_file(std::path::Path::new(&format!("{rig}-{kind}.csv")), &Default::default()).unwrap();
        let d = model_lab::diagnosis::diagnose(&plant, &[read("id")], &[read("check")], &|_| core::ops::ControlFlow::Continue(())).unwrap();
        println!("== {rig} {:?} {:?} unexplained {} {:?}", d.verdict, d.effects, d.unexplained, d.equivalents);
        println!("  {}", d.sentence);
        let steps: Vec<String> = d.ladder.iter().map(|s| format!("{:?} {:.3} x {:?}", s.added, s.explained_share, s.check_rms.iter().map(|(k, v)| format!("{:.2}", v / s.noise_floor[k])).collect::<Vec<_>>())).collect();
        println!("  {}", steps.join(" -> "));
        for c in d.candidates.iter().take(if std::env::var("ALL").is_ok() { 20 } else { 4 }) { println!("   {} {} EFE {:.3} ev {:.0} {} | {}", c.effect, c.variant, c.explained_share, c.evidence, c.parameters.iter().map(|p| format!("{}={:.4e} [{:.4e} {:.4e}]", p.key, p.value, p.low, p.high)).collect::<Vec<_>>().join(" "), match &c.detection_limit { model_lab::diagnosis::result::DetectionLimit::Size{key, value, ..} => format!("limit {key}={value:.3e}"), _ => "not excited".into()}); }
        for (k, v) in &d.distinguishability { let mut v: Vec<_> = v.iter().collect(); v.sort_by(|a, b| a.1.total_cmp(b.1)); println!("   distances from {k}: {:?}", v.iter().take(4).collect::<Vec<_>>()); }
        println!("   cost {:?}", d.cost);
        if std::env::var("NUI").is_ok() { for n in &d.nuisance { println!("     {} {:.4e} plain {:.4e} fitted {:.4e} [{:.4e} {:.4e}] {:?}", n.name, n.datasheet, n.plain, n.fitted, n.low, n.high, n.alarm); } }
    }
}
