// A program for `rigsim verify --exec ./triangulate`; standard C++17 alone:
//     g++ -O2 -std=c++17 docs/examples/verify/triangulate.cpp -o triangulate
// The midpoint of the shortest line between the two rays, after the lens distortion is undone.

#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

using Vector = std::array<double, 3>;
using Numbers = std::map<std::string, double>;
const double nan_value = std::numeric_limits<double>::quiet_NaN();

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// --- calibration.json: every number under its path, as "left.fx_px" or "right_from_left.R.0.2"

class Json {
public:
    Numbers numbers;
    explicit Json(const std::string& text) : at(text.c_str()) { value(""); }

private:
    const char* at;

    char next() {
        while (std::isspace(static_cast<unsigned char>(*at))) ++at;
        return *at;
    }

    void expect(char wanted) {
        if (next() != wanted) throw std::runtime_error("calibration.json: expected " + std::string(1, wanted));
        ++at;
    }

    std::string word() {
        std::string letters;
        expect('"');
        while (*at && *at != '"') {
            if (*at == '\\' && at[1]) ++at;
            letters += *at++;
        }
        expect('"');
        return letters;
    }

    void value(const std::string& path) {
        const std::string prefix = path.empty() ? "" : path + ".";
        const char first = next();
        if (first == '"') {
            word();
        } else if (first == '{' || first == '[') {
            const char last = first == '{' ? '}' : ']';
            ++at;
            for (int i = 0; next() != last; ++i) {
                if (i > 0) expect(',');
                std::string key = std::to_string(i);
                if (first == '{') {
                    key = word();
                    expect(':');
                }
                value(prefix + key);
            }
            ++at;
        } else {
            char* end;
            numbers[path] = std::strtod(at, &end);
            if (end == at) throw std::runtime_error("calibration.json: no number at " + path);
            at = end;
        }
    }
};

// --- one camera

struct Camera {
    double fx, fy, cx, cy, k1, k2, p1, p2, k3;

    Camera(const Numbers& numbers, const std::string& side)
        : fx(numbers.at(side + ".fx_px")), fy(numbers.at(side + ".fy_px")),
          cx(numbers.at(side + ".cx_px")), cy(numbers.at(side + ".cy_px")),
          k1(numbers.at(side + ".distortion.k1")), k2(numbers.at(side + ".distortion.k2")),
          p1(numbers.at(side + ".distortion.p1")), p2(numbers.at(side + ".distortion.p2")),
          k3(numbers.at(side + ".distortion.k3")) {}

    // direction with z = 1; NaN where the lens shows nothing
    Vector ray(double u, double v) const {
        const double xd = (u - cx) / fx, yd = (v - cy) / fy;
        double x = xd, y = yd;
        for (int step = 0; step < 20; ++step) {
            const double r2 = x * x + y * y;
            const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
            const double ex = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) - xd;
            const double ey = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y - yd;
            const double slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3));
            const double a = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x;
            const double b = x * y * slope + 2 * p1 * x + 2 * p2 * y;
            const double d = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
            const double det = a * d - b * b;
            // beyond its fold a lens would mirror or turn the picture: its derivative is not positive definite
            const bool met = std::hypot(ex, ey) < 1e-9 && a > 0 && det > 0;
            if (step == 19 && !met) return {nan_value, nan_value, 1};
            x -= (d * ex - b * ey) / det;
            y -= (a * ey - b * ex) / det;
        }
        return {x, y, 1};
    }
};

int main(int count, char** words) try {
    if (count != 2) throw std::runtime_error("usage: triangulate FOLDER");
    const std::string folder = words[1];

    std::ifstream calibration(folder + "/calibration.json");
    if (!calibration) throw std::runtime_error("no calibration.json in " + folder);
    const std::string text{std::istreambuf_iterator<char>(calibration), {}};
    const Numbers numbers = Json(text).numbers;
    const Camera left_camera(numbers, "left"), right_camera(numbers, "right");
    std::array<Vector, 3> R;
    Vector t;
    for (int i = 0; i < 3; ++i) {
        const std::string row = std::to_string(i);
        t[i] = numbers.at("right_from_left.t_m." + row);
        for (int j = 0; j < 3; ++j) R[i][j] = numbers.at("right_from_left.R." + row + "." + std::to_string(j));
    }
    const auto from_right = [&R](const Vector& p) {  // R^T p
        Vector q{};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) q[j] += R[i][j] * p[i];
        return q;
    };
    const Vector center = from_right({-t[0], -t[1], -t[2]});  // of the right camera, seen from the left one

    std::ifstream observations(folder + "/observations.csv");
    if (!observations) throw std::runtime_error("no observations.csv in " + folder);
    std::ofstream points(folder + "/points.csv");
    points << "id,x_m,y_m,z_m\n" << std::setprecision(17);
    std::string line;
    std::getline(observations, line);  // id,u_left,v_left,u_right,v_right
    while (std::getline(observations, line)) {
        const char* at = line.c_str();
        std::array<double, 5> cells;
        for (double& cell : cells) {
            char* end;
            cell = std::strtod(at, &end);  // reads nan as well
            if (end == at) throw std::runtime_error("observations.csv: cannot read " + line);
            at = *end == ',' ? end + 1 : end;
        }
        const Vector left = left_camera.ray(cells[1], cells[2]);
        const Vector right = from_right(right_camera.ray(cells[3], cells[4]));
        const Vector normal = cross(left, right);
        const double along_left = dot(cross(center, right), normal) / dot(normal, normal);
        const double along_right = dot(cross(center, left), normal) / dot(normal, normal);
        Vector point;
        for (int i = 0; i < 3; ++i) point[i] = 0.5 * (along_left * left[i] + center[i] + along_right * right[i]);
        const bool in_front = along_left > 0 && along_right > 0 && point[2] > 0 && dot(R[2], point) + t[2] > 0;
        points << static_cast<long>(cells[0]);
        for (double coordinate : point) points << ',' << (in_front ? coordinate : nan_value);
        points << '\n';
    }
    points.close();
    if (!points) throw std::runtime_error("points.csv cannot be written");
    return 0;
} catch (const std::exception& error) {
    std::cerr << "triangulate: " << error.what() << '\n';
    return 1;
}
