use fallwerk::*; use std::path::Path;
fn main(){
 let a:Vec<String>=std::env::args().collect();
 let b=building::read(Path::new(&a[1])).unwrap_or_else(|e|panic!("{e}"));
 let mut store=library::Store::open(Path::new("/tmp/lib")).unwrap();
 let t=std::time::Instant::now();
 let g=generate::generate(&b,&rules::RuleBase,&mut store,generate::Derive::Keep,&|_|{}).unwrap_or_else(|e|panic!("{e}"));
 println!("generate {:.2}s derived {:?} notes {:?}",t.elapsed().as_secs_f64(),g.derived,g.notes);
 for (k,e) in &g.entries { println!("{k} K {:.3e} {:.3e} ka {:.3e} peak {:?} asym {:.3} kin {:.3}",e.axes[0].curve.stiffness_nm_rad,e.axes[1].curve.stiffness_nm_rad,e.stiffness.axial_n_m,e.axes[0].curve.levels.iter().map(|l|(l.capacity.iter().map(|c|c[1]).fold(0.,f64::max)/1e3).round()).collect::<Vec<_>>(),e.quality.asymmetry,e.quality.kinetic_energy_ratio); }
 std::fs::write("/tmp/model.json",serde_json::to_string_pretty(&g.model).unwrap()).unwrap();
 let mut model=g.model.clone();
 if a.len()>2 && a[2]=="nobody" { model.contact.bodies=None; }
 let r=mbs::simulate(&model).unwrap_or_else(|e|panic!("{e}"));
 println!("mbs cpu {:.4} steps {} dt {:.2e} err {:.2e} contact {:?}",r.cpu_s,r.steps,r.time_step_s,r.energy_error,r.first_ground_contact_s);
 for e in &r.events { println!("{:.3} {:?}",e.time_s,e.kind); }
 let get=|id:&str| r.tracked.iter().find(|t|t.id==id).unwrap();
 for k in (0..r.times_s.len()).step_by(10){ let c1=get("S1.corner-00").displacement_m[k]; let c3=get("S3.corner-00").displacement_m[k]; let ct=get("C1-A2.top").displacement_m[k]; let c3b=get("S3.corner-01").displacement_m[k];
  println!("{:.2} S1c ({:.3},{:.3},{:.3}) S3c ({:.3},{:.3}) S3back({:.3},{:.3}) C1top ({:.3},{:.3}) KE {:.0} PL {:.0}",r.times_s[k],c1[0],c1[1],c1[2],c3[1],c3[2],c3b[1],c3b[2],ct[1],ct[2],r.energies.kinetic_j[k]/1e3,r.energies.plastic_j[k]/1e3); }
 let fe=fe::run::run(&b,&Default::default(),&mut |_|{}).unwrap();
 let f=study::facts(&b,&fe);
 let v=validate::Validation::of(&b,&fe,&f,&model,&r,0.0);
 println!("e_c {:.4} e_tot {:.4} contact {:?} hinges {:?} placed {:?} ratio {:.0} foot {:.3} agrees {}",v.e_to_contact,v.e_total,v.first_contact_s,v.hinges,v.hinges_placed,v.speed_ratio,v.footprint_overlap,v.agrees());
 for k in (0..v.e_curve.len()).step_by(10){print!("{:.2}:{:.3} ",v.times_s[k],v.e_curve[k]);} println!();
}
