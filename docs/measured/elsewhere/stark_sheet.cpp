// A sheet in STARK: stark_sheet SCENE SHEET.obj BODY.obj STEP BENDING SOLVER TIME CAP OUT [RESIDUAL STEP]
//
// SCENE is hang, ball, table or strip; BODY.obj is read for ball and table; BENDING is angles or quadratic, SOLVER cg
// or llt. Runs up to TIME seconds, or until the loop of steps took CAP CPU seconds. Writes a line `cpu time steps` to
// standard output, and to OUT for every step that was taken its time and all positions, in doubles.
#include <cstddef>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <vector>

#include <stark>

struct Mesh { std::vector<Eigen::Vector3d> points; std::vector<std::array<int, 3>> faces; };

static Mesh read(const std::string& path) {
    Mesh mesh;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") { double x, y, z; words >> x >> y >> z; mesh.points.push_back({x, y, z}); }
        if (kind == "f") { int a, b, c; words >> a >> b >> c; mesh.faces.push_back({a - 1, b - 1, c - 1}); }
    }
    if (mesh.faces.empty()) { std::fprintf(stderr, "no faces in %s\n", path.c_str()); std::exit(2); }
    return mesh;
}

static double cpu() {
    rusage use;
    getrusage(RUSAGE_SELF, &use);
    return use.ru_utime.tv_sec + use.ru_stime.tv_sec + 1e-6 * (use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

int main(int count, char** words) {
    if (count < 10) return 2;
    const std::string scene = words[1], bending = words[5], solver = words[6], out = words[9];
    const double step = std::atof(words[4]), end = std::atof(words[7]), cap = std::atof(words[8]);
    const bool strip = scene == "strip", contact = scene != "hang";
    const Mesh sheet = read(words[2]);

    stark::Settings settings;
    settings.output.simulation_name = "sheet";
    settings.output.output_directory = out + "-log";
    settings.output.enable_output = false;
    settings.output.enable_frame_writes = false;
    settings.output.console_verbosity = symx::Verbosity::Minimal;
    settings.execution.n_threads = 1;
    settings.simulation.gravity = {0.0, 0.0, -9.8};
    settings.simulation.max_time_step_size = step;
    settings.simulation.init_frictional_contact = contact;
    if (solver == "llt") settings.newton.linear_solver = symx::LinearSolver::DirectLLT;
    if (count > 11) {
        settings.newton.residual_tolerance_abs = std::atof(words[10]);
        settings.newton.step_tolerance = std::atof(words[11]);
    }
    stark::Simulation simulation(settings);
    if (contact) {
        auto global = simulation.interactions->contact->get_global_params();
        global.default_contact_thickness = strip ? 5e-5 : 5e-4;
        global.min_contact_stiffness = 1e6;
        global.friction_stick_slide_threshold = 0.01;
        simulation.interactions->contact->set_global_params(global);
    }

    const double rigidity = strip ? 5e-4 : 5e-5;
    const auto set = simulation.deformables->point_sets->add(sheet.points);
    stark::EnergyLumpedInertia::Params inertia;
    inertia.set_density(strip ? 0.08 : 0.1);
    simulation.deformables->lumped_inertia->add(set, sheet.faces, inertia);
    stark::EnergyTriangleStrain::Params strain;
    strain.set_elasticity_only(true);
    strain.set_thickness(1.0);
    strain.set_youngs_modulus(3e5);
    strain.set_poissons_ratio(0.3);
    simulation.deformables->triangle_strain->add(set, sheet.faces, strain);
    stark::EnergyDiscreteShells::Params bend;
    const bool quadratic = bending == "quadratic";
    bend.set_flat_rest_angle(quadratic);
    bend.set_stiffness(quadratic ? 2.0 / 3.0 * rigidity : rigidity / 6.0);
    simulation.deformables->discrete_shells->add(set, sheet.faces, bend);

    stark::EnergyPrescribedPositions::Params pin;
    pin.set_stiffness(1e6);
    if (scene == "hang") {
        std::vector<int> corner;
        for (int i = 0; i < (int)sheet.points.size(); i++)
            if ((sheet.points[i] - Eigen::Vector3d(0.0, 1.0, 0.0)).norm() < 1e-9) corner.push_back(i);
        simulation.deformables->prescribed_positions->add(set, corner, pin);
    } else if (strip) {
        // Two columns at each end are clamped; those on the right come up to a tenth within 1.5 s.
        std::vector<int> left, right;
        for (int i = 0; i < (int)sheet.points.size(); i++) {
            if (sheet.points[i].x() < 0.0026) left.push_back(i);
            if (sheet.points[i].x() > 0.2974) right.push_back(i);
        }
        simulation.deformables->prescribed_positions->add(set, left, pin);
        auto hand = simulation.deformables->prescribed_positions->add(set, right, pin);
        simulation.add_time_event(0.0, end, [=](double t) mutable {
            hand.set_transformation({-0.27 * std::min(t / 1.5, 1.0), 0.0, 0.0});
        });
    }
    if (contact) {
        auto own = simulation.interactions->contact->add_triangles(set, sheet.faces, {});
        own.set_friction(own, 0.3);
        if (!strip) {
            const Mesh body = read(words[3]);
            auto rigid = simulation.rigidbodies->add(1.0, Eigen::Matrix3d::Identity());
            simulation.rigidbodies->add_constraint_fix(rigid);
            auto other = simulation.interactions->contact->add_triangles(rigid, body.points, body.faces, {});
            own.set_friction(other, 0.3);
            other.disable_collision(other);
        }
    }

    std::ofstream states(out, std::ios::binary);
    double begun = -1.0, last = -1.0;
    long steps = 0;
    auto write = [&] {
        const double t = simulation.get_time();
        if (t <= last) return;
        last = t;
        states.write((const char*)&t, sizeof t);
        for (int i = 0; i < set.size(); i++) {
            const Eigen::Vector3d x = set.get_position(i);
            states.write((const char*)x.data(), sizeof x);
        }
        steps++;
    };
    write();
    // The energies are compiled before the first step: the clock starts just before it is solved.
    simulation.get_stark().callbacks->add_before_simulation([&] { begun = cpu(); });
    double took = 0.0;
    while (simulation.get_time() < end - 1e-9 && took < cap) {
        const double before = simulation.get_time();
        simulation.run_one_time_step();
        took = cpu() - begun;
        if (simulation.get_time() > before) write();
        if (simulation.get_time_step_size() < 2e-6) break;
    }
    std::printf("%.4f %.6f %ld\n", took, simulation.get_time(), steps - 1);
}
