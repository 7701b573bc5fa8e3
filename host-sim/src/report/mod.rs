//! stub
pub mod table {
    use crate::verify::result::{Treatment, Verification};
    #[must_use]
    pub fn text(v: &Verification) -> String {
        let mut s = String::new();
        for c in &v.cameras {
            s += &format!(
                "{} worst {:?} solver {:e} coord {} stat {} printed {}\n",
                c.name,
                c.worst,
                c.solver_error_mm() * 1e6,
                c.coordinate_errors().max_mm() * 1e6,
                c.errors(Treatment::Static).max_mm() * 1e3,
                c.errors(Treatment::Printed).max_mm() * 1e3
            );
        }
        s
    }
}
