// Pinocchio's algorithms, header-only: nanoseconds for each state, medians of samples taken in turn. benches/peers/algorithms.py builds and runs it.
// Standard input: a robot as lines "joint PARENT KIND AXIS PLACEMENT MASS COM INERTIA", as that script writes them; then "tip JOINT".
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr int STATES = 32;
constexpr double SAMPLE = 3e5;

static Eigen::Vector3d vector3() {
    Eigen::Vector3d x;
    std::cin >> x[0] >> x[1] >> x[2];
    return x;
}

static Eigen::Matrix3d matrix3() {
    Eigen::Matrix3d m;
    for (int i = 0; i < 9; ++i) std::cin >> m(i / 3, i % 3);
    return m;
}

static pin::JointModel joint(const std::string& kind, const Eigen::Vector3d& axis) {
    if (kind == "RX") return pin::JointModelRX();
    if (kind == "RY") return pin::JointModelRY();
    if (kind == "RZ") return pin::JointModelRZ();
    if (kind == "RU") return pin::JointModelRevoluteUnaligned(axis);
    if (kind == "PX") return pin::JointModelPX();
    if (kind == "PY") return pin::JointModelPY();
    if (kind == "PZ") return pin::JointModelPZ();
    if (kind == "PU") return pin::JointModelPrismaticUnaligned(axis);
    return pin::JointModelFreeFlyer();
}

static double now() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * t.tv_sec + t.tv_nsec;
}

int main(int count, char** words) {
    const int samples = count > 1 ? std::stoi(words[1]) : 21;
    pin::Model model;
    pin::FrameIndex tip = 0;
    for (std::string word; std::cin >> word;) {
        int number;
        std::string kind;
        std::cin >> number;
        if (word == "tip") {
            tip = model.addFrame(pin::Frame("tip", number, pin::SE3::Identity(), pin::OP_FRAME));
            break;
        }
        std::cin >> kind;
        const Eigen::Vector3d axis = vector3();
        const Eigen::Matrix3d rotation = matrix3();
        const Eigen::Vector3d place = vector3();
        double mass;
        std::cin >> mass;
        const Eigen::Vector3d com = vector3();
        const Eigen::Matrix3d inertia = matrix3();
        const auto id = model.addJoint(number, joint(kind, axis), pin::SE3(rotation, place), "j" + std::to_string(model.njoints));
        model.appendBodyToJoint(id, pin::Inertia(mass, com, inertia), pin::SE3::Identity());
    }
    pin::Data data(model);
    std::vector<Vector> q(STATES), v(STATES), a(STATES);
    for (int s = 0; s < STATES; ++s) {
        const auto numbers = [s](int width, double seed) {
            Vector x(width);
            for (int k = 0; k < width; ++k) x[k] = 1.5 * std::sin(seed + 1.7 * s + 0.9 * k);
            return x;
        };
        q[s] = numbers(model.nq, 0.1);
        pin::normalize(model, q[s]);
        v[s] = numbers(model.nv, 0.5);
        a[s] = numbers(model.nv, 0.8);
    }
    Matrix square = Matrix::Zero(model.nv, model.nv), lower = square;
    Matrix six = Matrix::Zero(6, model.nv);
    using pin::Convention;
    const std::vector<std::pair<std::string, std::function<void(int)>>> works = {
        {"placements", [&](int s) { pin::forwardKinematics(model, data, q[s]); }},
        {"rnea", [&](int s) { pin::rnea(model, data, q[s], v[s], a[s]); }},
        {"crba", [&](int s) { pin::crba(model, data, q[s], Convention::WORLD); }},
        {"crba", [&](int s) { pin::crba(model, data, q[s], Convention::LOCAL); }},
        {"aba", [&](int s) { pin::aba(model, data, q[s], v[s], a[s], Convention::WORLD); }},
        {"aba", [&](int s) { pin::aba(model, data, q[s], v[s], a[s], Convention::LOCAL); }},
        {"mass inverse", [&](int s) { pin::computeMinverse(model, data, q[s]); }},
        {"mass inverse",
         [&](int s) {
             pin::crba(model, data, q[s], Convention::WORLD);
             pin::cholesky::decompose(model, data);
             pin::cholesky::computeMinv(model, data, square);
         }},
        {"coriolis", [&](int s) { pin::computeCoriolisMatrix(model, data, q[s], v[s]); }},
        {"rnea derivatives", [&](int s) { pin::computeRNEADerivatives(model, data, q[s], v[s], a[s]); }},
        {"aba derivatives", [&](int s) { pin::computeABADerivatives(model, data, q[s], v[s], a[s]); }},
        {"frame jacobian", [&](int s) { pin::computeFrameJacobian(model, data, q[s], tip, pin::LOCAL, six); }},
    };
    const auto time = [&](const std::function<void(int)>& work, int calls) {
        const double begun = now();
        for (int call = 0; call < calls; ++call)
            for (int s = 0; s < STATES; ++s) work(s);
        return (now() - begun) / (calls * STATES);
    };
    std::vector<int> calls;
    for (const auto& [name, work] : works) calls.push_back(std::max(1, int(SAMPLE / (time(work, 3) * STATES))));
    std::vector<std::vector<double>> times(works.size());
    for (int sample = 0; sample < samples; ++sample)
        for (size_t k = 0; k < works.size(); ++k) times[k].push_back(time(works[k].second, calls[k]));
    std::map<std::string, double> best;
    for (size_t k = 0; k < works.size(); ++k) {
        std::sort(times[k].begin(), times[k].end());
        const double median = times[k][samples / 2];
        const auto [at, is_new] = best.try_emplace(works[k].first, median);
        if (!is_new) at->second = std::min(at->second, median);
    }
    for (const auto& [name, median] : best) std::cout << name << '\t' << median << '\n';
    // What was worked out, for the eye: torques and masses of the first state.
    pin::rnea(model, data, q[0], v[0], a[0]);
    pin::crba(model, data, q[0], Convention::WORLD);
    std::cout << "sums\t" << data.tau.norm() << '\t' << data.M.diagonal().sum() << '\n';
}
