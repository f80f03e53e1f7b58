use fallwerk::building::*; use fallwerk::fe::{mesh::*,dynamics::*,contact::RigidSurfaces};
// elastic / elastic-plastic cantilever of verification B.1
fn main(){
 let a:Vec<f64>=std::env::args().skip(1).map(|s|s.parse().unwrap()).collect();
 let n=a[0] as usize; let sy=a[1];
 let (nx,ny,nz)=(n,n/10,n/10);
 let hp=|p,s|HardeningPoint{plastic_strain:p,stress_pa:s};
 // tangent 300 MPa of total strain: H = Et/(1-Et/E)
 let h=300e6/(1.-300e6/30e9);
 let law=Homogenised{density_kg_m3:2500.,youngs_modulus_pa:30e9,poisson_ratio:0.2,hardening:vec![hp(0.,sy),hp(1.0,sy+h)],critical_plastic_strain:10.};
 let id=|i:usize,j:usize,k:usize| (k*(ny+1)+j)*(nx+1)+i;
 let mut nodes=vec![[0.0;3];(nx+1)*(ny+1)*(nz+1)];
 let mut fixed=vec![];
 for k in 0..=nz{for j in 0..=ny{for i in 0..=nx{ nodes[id(i,j,k)]=[10.0*i as f64/nx as f64,j as f64/ny as f64,k as f64/nz as f64]; if i==0{fixed.push(id(i,j,k));}}}}
 let mut elements=vec![];
 for k in 0..nz{for j in 0..ny{for i in 0..nx{ elements.push(Element{nodes:[id(i,j,k),id(i+1,j,k),id(i+1,j+1,k),id(i,j+1,k),id(i,j,k+1),id(i+1,j,k+1),id(i+1,j+1,k+1),id(i,j+1,k+1)],part:0,law:0,smear:1.,strength:1.}); }}}
 let mesh=Mesh{nodes,elements,laws:vec![law],fixed,parts:vec!["beam".into()]};
 let mut b=Dynamics::new(&mesh,9.81,RigidSurfaces::default(),false);
 let tip=id(nx,ny/2,nz/2); let z0=mesh.nodes[tip][2];
 let (mut peak,mut tp)=(0.0f64,0.0); let mut next=0.1;
 let t0=std::time::Instant::now();
 while b.time_s<0.5 { b.step(false); let u=b.x[tip][2]-z0; if u<peak && b.time_s<0.12 {peak=u;tp=b.time_s;} if b.time_s>=next-1e-9 { println!("t {:.2} u {:.3} mm  E {:?}",b.time_s,u*1e3,b.blocks.energies_j()); next+=0.1; } }
 let w=t0.elapsed().as_secs_f64();
 println!("peak {:.3} mm at {:.5}; steps {} dt {:.3e}; {:.1} ns/element-cycle", peak*1e3,tp,b.steps,b.dt_s, w*1e9/(b.steps as f64*mesh.elements.len() as f64));
}
