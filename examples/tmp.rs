use fallwerk::base::geom::Aabb; use fallwerk::building::*; use std::collections::BTreeMap;
fn main(){
 let a:Vec<f64>=std::env::args().skip(1).map(|s|s.parse().unwrap()).collect();
 let g=|i:usize,d:f64| a.get(i).copied().unwrap_or(d);
 let crit=g(0,0.1); let size=g(1,0.4); let end=g(2,2.5); let sy=g(3,15e6);
 let law=Homogenised{density_kg_m3:2500.,youngs_modulus_pa:16.5e9,poisson_ratio:0.2,hardening:vec![HardeningPoint{plastic_strain:0.,stress_pa:sy},HardeningPoint{plastic_strain:0.01,stress_pa:sy*1.1},HardeningPoint{plastic_strain:0.1,stress_pa:sy*1.1667}],critical_plastic_strain:crit};
 let mut materials=BTreeMap::new(); materials.insert("RC".into(),Material::Homogenised(law));
 let mut sections=BTreeMap::new();
 for n in ["column","beam","slab"]{ sections.insert(n.to_string(),Section{id:n.into(),shape:SectionShape::Plate{thickness_m:0.25,bar_diameter_m:0.01,bar_spacing_m:0.15,bar_cover_m:0.03},concrete:"".into(),steel:"".into(),law:"RC".into()}); }
 let mut members=vec![]; let mut supports=vec![];
 let xs=[0.,6.]; let ys=[0.,5.];
 for s in 1..=3u32{ let z=3.5*s as f64;
  for (i,x) in xs.iter().enumerate(){ for (j,y) in ys.iter().enumerate(){ let id=format!("C{}-{}{}",s,["A","B"][i],j+1);
   if s==1{supports.push(Support{member:id.clone(),face:Face::Bottom});}
   members.push(Member{id,kind:MemberKind::Column,section:"column".into(),solid:Aabb{min:[x-0.2,y-0.2,z-3.5],max:[x+0.2,y+0.2,z]},axis:2,storey:Some(s)});}}
  for (j,y) in ys.iter().enumerate(){ members.push(Member{id:format!("B{s}-A{0}-B{0}",j+1),kind:MemberKind::Beam,section:"beam".into(),solid:Aabb{min:[-0.2,y-0.15,z-0.5],max:[6.2,y+0.15,z]},axis:0,storey:Some(s)});}
  for (i,x) in xs.iter().enumerate(){ members.push(Member{id:format!("B{s}-{0}1-{0}2",["A","B"][i]),kind:MemberKind::Beam,section:"beam".into(),solid:Aabb{min:[x-0.15,0.2,z-0.5],max:[x+0.15,4.8,z]},axis:1,storey:Some(s)});}
  members.push(Member{id:format!("S{s}"),kind:MemberKind::Slab,section:"slab".into(),solid:Aabb{min:[-0.2,-0.2,z-0.25],max:[6.2,5.2,z]},axis:2,storey:Some(s)});
 }
 let events=["C1-A1","C1-B1"].iter().map(|m|Charge{id:format!("charge {m}"),member:m.to_string(),stretch_m:None,time_s:0.}).collect();
 let b=Building{name:"ref".into(),description:"".into(),materials,sections,members,supports,ground:Ground{level_m:0.,friction:0.5},obstacles:vec![],preparation:vec![],events,settings:Settings{mesh_size_m:size,end_time_s:end,..Default::default()}};
 let r=fallwerk::fe::run::run(&b,&Default::default(),&mut |p|{ if ((p.time_s*100.).round() as i64)%50==0 {eprintln!("{:.2}",p.time_s)} }).unwrap_or_else(|e|panic!("{e}"));
 println!("{:#?}",r.summary);
 println!("snapped {:?}", r.snapped.iter().map(|s|(s.member.clone(),s.volume_ratio)).collect::<Vec<_>>().first());
 let f=fallwerk::study::facts(&b,&r); for z in &f.ends { println!("{} first {:?} peak {:.2} pl {:.3} er {:.2} fr {:?}",z.id,z.first_s,z.peak_rate_1_s,z.plastic_strain,z.eroded,z.fracture_s);} for m in &f.members {println!("{} {:.2} {:.2}",m.member,m.rigid_share_before_contact,m.rigid_share);}
 let get=|id:&str| r.tracked.iter().find(|t|t.id==id).unwrap();
 for k in (0..r.times_s.len()).step_by(10){ let e=r.energies[k]; let c1=get("S1.corner-00").displacement_m[k]; let c3=get("S3.corner-00").displacement_m[k]; let ct=get("C1-A2.top").displacement_m[k]; let c3b=get("S3.corner-01").displacement_m[k];
  println!("{:.2} S1c ({:.3},{:.3},{:.3}) S3c ({:.3},{:.3}) S3back({:.3},{:.3}) C1top ({:.3},{:.3}) KE {:.0} IE {:.0} er {:.0} HG {:.0} V {:.0} G {:.0} C {:.0} res {:.0}",r.times_s[k],c1[0],c1[1],c1[2],c3[1],c3[2],c3b[1],c3b[2],ct[1],ct[2],e.kinetic_j/1e3,e.internal_j/1e3,e.eroded_j/1e3,e.hourglass_j/1e3,e.viscous_j/1e3,e.gravity_j/1e3,(e.contact_j+e.friction_j)/1e3,e.residual_j/1e3);}
 let mut byp:BTreeMap<String,(usize,f64)>=BTreeMap::new();
 for d in &r.deaths{ let c=r.mesh.center(d.element); let k=format!("{} {:?} z={:.1}",r.mesh.parts[r.mesh.elements[d.element].part],d.cause,c[2]); let e=byp.entry(k).or_insert((0,d.time_s)); e.0+=1;}
 for (k,v) in byp.iter().filter(|x|!x.0.contains("Removed")).take(60){println!("{k}: {} first {:.3}",v.0,v.1);}
 for t in r.touches.iter().take(12){println!("{t:?}");}
}
