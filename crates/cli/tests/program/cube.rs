//! A run in space.

use std::path::Path;

/// The output of the program in three dimensions.
#[test]
fn the_program_in_space() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cube");
    let stickslip = |args: &[&str]| {
        let scene = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/cube.toml"));
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.arg(args[0]).arg(scene).args(["--set", "mesh.elements=[2,2,2]"]).args(&args[1..]).output().unwrap()
    };
    let run = stickslip(&["run", "--out", folder.to_str().unwrap(), "--json"]);
    assert!(run.status.success(), "{run:?}");
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let unknowns = ["u", "p_t", "p_o", "p_n"].map(|name| report["unknowns"][name].as_u64().unwrap());
    assert_eq!(unknowns, [54, 6, 6, 6]);
    assert!(report["final"]["sum_p_o"].as_f64().unwrap().abs() > 1e5, "{}", report["final"]);
    let table = std::fs::read_to_string(folder.join("contact_0010.csv")).unwrap();
    let columns = "x,y,z,p_n,p_t,p_o,sigma_n,sigma_t,sigma_o,w_n,w_t,w_o,gap,slip_t,slip_o,f_x,f_y,f_z,status,node,n_x,n_y,n_z,t_x,t_y,t_z,o_x,o_y,o_z,sigma_along,sigma_across,sigma_shear,von_mises";
    assert_eq!((table.lines().next().unwrap(), table.lines().count()), (columns, 7));
    let forces = std::fs::read_to_string(folder.join("forces.csv")).unwrap();
    let columns = "index,time,boundary,f_x,f_y,f_z,m_x,m_y,m_z,sum_p_n,sum_p_t,sum_p_o,kind,balance,u_x,u_y,u_z,slip_state,friction_used";
    assert_eq!(forces.lines().next().unwrap(), columns);
    let of_kind = |kind: &str| forces.lines().filter(|line| line.contains(kind)).count();
    assert_eq!([",contact,", ",support,", ",load,"].map(of_kind), [10, 10, 30]);
    assert!(folder.join("contact_0010.svg").exists() && folder.join("fields_0010.vtu").exists());

    let check = String::from_utf8(stickslip(&["check"]).stdout).unwrap();
    assert!(check.contains("12 tangential forces p_t and p_o; 6 nodes slide in a plane\n"), "{check}");
    let refused = stickslip(&["run", "--uniqueness"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&refused.stderr)
            .contains("the uniqueness can be computed only for nodes that slide along a line")
    );
    assert!(!String::from_utf8_lossy(&refused.stdout).contains("verdict"));
}
