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
 let (mesh,_)=fallwerk::fe::mesh::Mesh::of(&b,size);
 for (id,end) in [("C1-A2",fallwerk::building::ends::End::Lower),("C1-A2",fallwerk::building::ends::End::Upper),("C2-A2",fallwerk::building::ends::End::Lower)] {
  let m=fallwerk::rc::EndModel::cut(&b,&mesh,id,end).unwrap();
  println!("{id} {end:?} elements {} fixed {} section {} {} tip {} len {}",m.mesh.elements.len(),m.mesh.fixed.len(),m.section_nodes.len(),m.section_elements.len(),m.tip_nodes.len(),m.length_m);
  let t=std::time::Instant::now();
  let c=fallwerk::rc::derive(&m,&|_,_|{}).unwrap_or_else(|e|panic!("{e}"));
  println!("time {:.1} ka {:.3e} ks {:.3e} kt {:.3e} T {:.3e} asym {:.4}",t.elapsed().as_secs_f64(),c.axial_stiffness_n_m,c.shear_stiffness_n_m[0],c.torsional_stiffness_nm_rad,c.tensile_capacity_n,c.asymmetry);
  for ax in 0..2 { for p in &c.axes[ax] { print!("ax{ax} N {:.0} kN n={} failed {} kin {:.4} erl {:.2}: ",p.axial_force_n/1e3,p.points.len(),p.failed,p.kinetic_share,p.eroded_length_m);
   let mut next=0.0; for q in &p.points { if q[0]>=next { print!("({:.4},{:.1}) ",q[0],q[1]/1e3); next=if q[0]<0.01{q[0]+0.001}else{q[0]*1.3}; } } println!(); } }
 }
}
