//! temporary
pub mod action; pub mod value; pub mod features;
pub use action::{Action,Aspect}; pub use value::{Subject,SubjectKind,Value};
/// f
#[derive(Debug, Clone)] pub struct Firing { /// r
 pub rule:String, /// w
 pub words:String, /// a
 pub action:Action, /// i
 pub in_range:bool }
/// rb
pub struct RuleBase;
impl RuleBase { /// e
 pub fn evaluate(&self,s:&Subject)->Vec<Firing>{ let f=|rule:&str,action|Firing{rule:rule.into(),words:rule.into(),action,in_range:true};
  match s.kind { SubjectKind::Member=> if s.features["member.kind"]==Value::from("column"){vec![f("column-rigid",Action::RigidBody)]}else{vec![f("plate-merge",Action::MergeRigid)]}, _=>vec![f("hinge",Action::Hinge),f("springs",Action::TranslationalSpring)] } } }
