// Draws what every material answers to uniaxial and equibiaxial stretch, simple shear and change of volume:
// one picture (SVG) a page of docs/materials/.
//
//   isochor_material_responses [folder]        (docs/figures/materials)
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "bench/material_response.h"
#include "options.h"

namespace {

using namespace isochor;

// A law with its shear modulus at small strain at one pascal, by Poisson's ratio.
struct Law {
  std::string name;
  std::function<Result<MaterialPtr>(double)> make;
};
struct Picture {
  std::string file;
  std::vector<Law> laws;
  bool pure_shear = false;  // in place of simple shear
};

ElasticConstants constants(double poisson) {
  ElasticConstants c;
  c.young = 2 * (1 + poisson);
  c.poisson = poisson;
  return c;
}

Law elastic(const char* name, Result<MaterialPtr> (*make)(const ElasticConstants&)) {
  return {name, [make](double nu) { return make(constants(nu)); }};
}

// All are alike in y and z, as the uniaxial states assume.
std::vector<Picture> elastic_pictures() {
  const Law reference = elastic("neo_hookean", neo_hookean);
  return {
      {"neo_hookean", {reference, elastic("neo_hookean_ogden", neo_hookean_ogden)}},
      {"stable_neo_hookean",
       {elastic("stable_neo_hookean", stable_neo_hookean),
        elastic("stable_neo_hookean_barrier", stable_neo_hookean_barrier)}},
      {"isochoric",
       {elastic("isochoric_neo_hookean", isochoric_neo_hookean),
        {"isochoric_extended, threshold 0.6",
         [](double nu) { return isochoric_extended(constants(nu), 0.6); }}}},
      {"mooney_rivlin",
       {{"mooney_rivlin, c2 = c1",
         [](double nu) {
           return mooney_rivlin({0.25, 0.25, nu});
         }},
        {"mooney_rivlin, c2 = c1/9",
         [](double nu) {
           return mooney_rivlin({0.45, 0.05, nu});
         }}}},
      {"stiffening",
       {{"fung, mu0 = 0.5, mu1 = 0.2, gamma = 2.5",
         [](double nu) {
           return fung({0.5, 0.2, 2.5, nu});
         }},
        {"arruda_boyce, 8 links",
         [](double nu) {
           const double b1 = 1.0 / 40, b2 = 11.0 / (175 * 64);
           return arruda_boyce({1 / (1 + 3 * b1 + 9 * b2), b1, b2, nu});
         }}}},
      {"ogden",
       {{"ogden, alpha = 1.3, 5, -2 (Treloar's rubber)",
         [](double nu) {
           const double scale = 2 / (1.491 * 1.3 + 0.003 * 5 + 0.0237 * 2);
           return ogden({{{1.491 * scale, 1.3}, {0.003 * scale, 5}, {-0.0237 * scale, -2}}, nu});
         }}}},
  };
}

std::vector<Picture> simple_pictures() {
  return {
      {"corotated", {elastic("corotated", corotated), elastic("fixed_corotated", fixed_corotated)}},
      {"stvk",
       {elastic("stvk", stvk),
        {"stvk_resistant, r = 1000 mu", [](double nu) { return stvk_resistant(constants(nu), 1000); }}}},
      {"linear", {elastic("linear", linear)}},
      {"fibers",
       {{"neo_hookean, fibers along x, k1 = mu, k2 = 0.1",
         [](double nu) -> Result<MaterialPtr> {
           auto matrix = neo_hookean(constants(nu));
           if (!matrix) return matrix;
           return with_fibers(std::move(matrix).value(), {{{1, 0, 0}, 1, 0.1, 0, {}}});
         }},
        {"the same, k2 = 1",
         [](double nu) -> Result<MaterialPtr> {
           auto matrix = neo_hookean(constants(nu));
           if (!matrix) return matrix;
           return with_fibers(std::move(matrix).value(), {{{1, 0, 0}, 1, 1, 0, {}}});
         }}}},
  };
}

std::vector<Picture> uncoupled_pictures() {
  return {
      {"uncoupled",
       {{"isochoric_mooney_rivlin, c2 = c1/4",
         [](double nu) {
           return isochoric_mooney_rivlin({0.4, 0.1, nu});
         }},
        {"isochoric_ogden, alpha = 1.3, 5, -2 (Treloar's rubber)",
         [](double nu) {
           const double scale = 2 / (0.63 * 1.3 + 0.0012 * 5 + 0.01 * 2);
           return isochoric_ogden({{{0.63 * scale, 1.3}, {0.0012 * scale, 5}, {-0.01 * scale, -2}}, nu});
         }}},
       true},
      {"yeoh",
       {{"isochoric_yeoh, c = 1/2, -1/50, 1/1000",
         [](double nu) {
           return isochoric_yeoh({{0.5, -0.02, 0.001}, nu});
         }},
        {"yeoh, the same",
         [](double nu) {
           return yeoh({{0.5, -0.02, 0.001}, nu});
         }}},
       true},
      {"gent",
       {{"isochoric_gent, jm = 10",
         [](double nu) {
           return isochoric_gent({1, 10, nu});
         }},
        {"gent, jm = 10",
         [](double nu) {
           return gent({1, 10, nu});
         }}},
       true},
      {"chains",
       {{"isochoric_arruda_boyce, locking stretch 2",
         [](double nu) {
           constexpr double n = 4;
           const double slope = 1 + 3 / (5 * n) + 99 / (175 * n * n) + 513 / (875 * n * n * n) +
                                81 * 519 / (67375 * n * n * n * n);
           return isochoric_arruda_boyce({1 / slope, 0, 0, nu, 0, 0, 2});
         }},
        {"isochoric_fung, mu0 = 0.5, mu1 = 0.2, gamma = 2.5",
         [](double nu) {
           return isochoric_fung({0.5, 0.2, 2.5, nu});
         }}},
       true},
  };
}

std::vector<Picture> other_pictures() {
  return {
      {"veronda_westmann",
       {{"isochoric_veronda_westmann, c2 = 0.5",
         [](double nu) {
           return isochoric_veronda_westmann({2, 0.5, nu});
         }},
        {"veronda_westmann, c2 = 0.1, log J",
         [](double nu) {
           return veronda_westmann({10, 0.1, nu, {VolumeEnergy::logarithmic, -1}});
         }}},
       true},
      {"holmes_mow",
       {{"isochoric_holmes_mow, beta = 0.3",
         [](double nu) {
           return isochoric_holmes_mow({1, 0.3, nu});
         }},
        {"holmes_mow, beta = 0.3",
         [](double nu) {
           return holmes_mow({1, 0.3, nu});
         }}},
       true},
      {"fiber_laws",
       {{"isochoric, k1 = mu, k2 = 1, dispersion 0.1",
         [](double nu) -> Result<MaterialPtr> {
           auto matrix = isochoric_yeoh({{0.5}, nu});
           if (!matrix) return matrix;
           FiberFamily f;
           f.k1 = f.k2 = 1;
           f.dispersion = 0.1;
           f.isochoric = true;
           return with_fibers(std::move(matrix).value(), {f});
         }},
        {"toe, k1 = mu/2, k2 = 5, straight from 1.3",
         [](double nu) -> Result<MaterialPtr> {
           auto matrix = isochoric_yeoh({{0.5}, nu});
           if (!matrix) return matrix;
           FiberFamily f;
           f.law = FiberLaw::toe;
           f.k1 = 0.5;
           f.k2 = 5;
           f.straight_modulus = 11;
           f.straight_stretch = 1.3;
           f.isochoric = true;
           return with_fibers(std::move(matrix).value(), {f});
         }}},
       true},
      {"compression_penalty",
       {{"isochoric_extended, penalty 2 mu, beta = 0",
         [](double nu) -> Result<MaterialPtr> {
           auto base = isochoric_extended(constants(nu));
           if (!base) return base;
           return with_compression_penalty(std::move(base).value(), {2, 0});
         }},
        {"the same, beta = 9",
         [](double nu) -> Result<MaterialPtr> {
           auto base = isochoric_extended(constants(nu));
           if (!base) return base;
           return with_compression_penalty(std::move(base).value(), {2, 9});
         }}}},
  };
}

std::vector<Picture> pictures() {
  std::vector<Picture> all;
  for (const auto& part : {elastic_pictures(), simple_pictures(), uncoupled_pictures(), other_pictures()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

struct Curve {
  std::vector<std::pair<double, double>> points;
  std::string color, dash;
  double width = 2;
};
struct Panel {
  std::string title, x_name, y_name;
  double x0, x1, y0, y1, x_step, y_step;
  std::vector<Curve> curves;
};

// Curves of one block in the four panels.
void draw(const response::Block& block, const std::string& color, const std::string& dash, double width,
          bool pure_shear, Panel panels[4]) {
  constexpr int n = 80;
  Curve c[4];
  for (Curve& curve : c) curve.color = color, curve.dash = dash, curve.width = width;
  for (int kind = 0; kind < 4; ++kind) {
    const Panel& p = panels[kind];
    if (kind == 3 && block.incompressible) continue;
    // From rest outward both ways, so that each state starts from its neighbor.
    for (const double end : {p.x0, p.x1}) {
      const double rest = kind == 2 && !pure_shear ? 0 : 1;
      double side = 1;
      std::vector<std::pair<double, double>> points;
      for (int i = 0; i <= n; ++i) {
        const double x = rest + (end - rest) * i / n;
        double y = 0;
        if (kind == 0) y = response::uniaxial(block, x, side);
        if (kind == 1) y = response::equibiaxial(block, x, side);
        if (kind == 2)
          y = pure_shear ? response::pure_shear(block, x, side) : response::simple_shear(block, x);
        if (kind == 3) y = response::volumetric(block, x);
        if (!std::isfinite(y)) break;
        points.push_back({x, y});
      }
      if (end == p.x0) std::reverse(points.begin(), points.end());
      c[kind].points.insert(c[kind].points.end(), points.begin(), points.end());
    }
    panels[kind].curves.push_back(std::move(c[kind]));
  }
}

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::abs(v) < 1e-12 ? 0.0 : v);
  return text;
}

class Svg {
 public:
  explicit Svg(const std::string& path) : out_(path) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 920 700\" font-family=\"sans-serif\" "
            "font-size=\"13\">\n<rect width=\"920\" height=\"700\" fill=\"white\"/>\n";
  }
  bool close() {
    out_ << "</svg>\n";
    out_.close();
    return out_.good();
  }
  void text(double x, double y, const std::string& what, const char* anchor, const char* more = "") {
    out_ << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" text-anchor=\"" << anchor << "\" "
         << more << ">" << what << "</text>\n";
  }
  void line(double x0, double y0, double x1, double y1, const std::string& color, double width,
            const std::string& dash = "") {
    out_ << "<line x1=\"" << number(x0) << "\" y1=\"" << number(y0) << "\" x2=\"" << number(x1) << "\" y2=\""
         << number(y1) << "\" stroke=\"" << color << "\" stroke-width=\"" << width << "\"";
    if (!dash.empty()) out_ << " stroke-dasharray=\"" << dash << "\"";
    out_ << "/>\n";
  }
  void panel(const Panel& p, double left, double top, double width, double height, int id) {
    const auto X = [&](double x) { return left + width * (x - p.x0) / (p.x1 - p.x0); };
    const auto Y = [&](double y) { return top + height * (p.y1 - y) / (p.y1 - p.y0); };
    out_ << "<clipPath id=\"c" << id << "\"><rect x=\"" << left << "\" y=\"" << top << "\" width=\"" << width
         << "\" height=\"" << height << "\"/></clipPath>\n";
    for (double x = p.x_step * std::ceil(p.x0 / p.x_step); x <= p.x1 + 1e-9; x += p.x_step) {
      line(X(x), top, X(x), top + height, "#e4e4e4", 1);
      text(X(x), top + height + 17, number(x), "middle");
    }
    for (double y = p.y_step * std::ceil(p.y0 / p.y_step); y <= p.y1 + 1e-9; y += p.y_step) {
      line(left, Y(y), left + width, Y(y), std::abs(y) < 1e-9 ? "#909090" : "#e4e4e4", 1);
      text(left - 6, Y(y) + 4, number(y), "end");
    }
    text(left + width / 2, top - 8, p.title, "middle", "font-weight=\"bold\"");
    text(left + width / 2, top + height + 34, p.x_name, "middle");
    text(left + 6, top + 16, p.y_name, "start", "fill=\"#606060\"");
    out_ << "<g clip-path=\"url(#c" << id << ")\" fill=\"none\">\n";
    for (const Curve& c : p.curves) {
      if (c.points.empty()) continue;
      out_ << "<polyline stroke=\"" << c.color << "\" stroke-width=\"" << c.width << "\"";
      if (!c.dash.empty()) out_ << " stroke-dasharray=\"" << c.dash << "\"";
      out_ << " points=\"";
      for (const auto& [x, y] : c.points) {
        // Far outside there is nothing to see.
        const double inside = std::clamp(y, p.y0 - 10 * (p.y1 - p.y0), p.y1 + 10 * (p.y1 - p.y0));
        char pair[48];
        std::snprintf(pair, sizeof pair, "%.1f,%.1f ", X(x), Y(inside));
        out_ << pair;
      }
      out_ << "\"/>\n";
    }
    out_ << "</g>\n";
  }

 private:
  std::ofstream out_;
};

bool draw_picture(const Picture& picture, const std::string& folder) {
  Panel panels[4] = {{"uniaxial", "stretch", "nominal stress / μ", 0.4, 3, -6, 6, 0.4, 2, {}},
                     {"equibiaxial", "stretch", "nominal stress / μ", 0.4, 3, -6, 6, 0.4, 2, {}},
                     {"simple shear", "shear γ", "shear stress / μ", 0, 2, 0, 4, 0.5, 1, {}},
                     {"volumetric", "J", "tr σ / 3μ", 0.2, 2, -6, 3, 0.2, 1, {}}};
  if (picture.pure_shear) {
    panels[2] = {"pure shear", "stretch", "nominal stress / μ", 0.4, 3, -6, 6, 0.4, 2, {}};
  }
  const auto add = [&](const Law& law, double nu, const std::string& color, const char* dash, double width) {
    auto made = law.make(nu);
    if (!made) {
      std::fprintf(stderr, "%s at nu = %g: %s\n", law.name.c_str(), nu, made.error().c_str());
      std::exit(1);
    }
    if (const auto block = response::Block::of(*made.value()))
      draw(*block, color, dash, width, picture.pure_shear, panels);
  };
  constexpr const char* colors[] = {"#0b62a4", "#d1495b"};
  add(elastic("neo_hookean", neo_hookean), 0.5, "#b0b0b0", "", 4);
  for (std::size_t i = 0; i < picture.laws.size(); ++i) {
    add(picture.laws[i], 0.3, colors[i], "6 4", 2);
    add(picture.laws[i], 0.5, colors[i], i == 1 ? "12 3" : "", 2);
  }
  Svg svg(folder + "/" + picture.file + ".svg");
  for (int k = 0; k < 4; ++k) svg.panel(panels[k], 60 + 450 * (k % 2), 76 + 312 * (k / 2), 380, 240, k);
  double x = 60;
  for (std::size_t i = 0; i < picture.laws.size(); ++i) {
    svg.line(x, 22, x + 30, 22, colors[i], 2, i == 1 ? "12 3" : "");
    svg.text(x + 36, 26, picture.laws[i].name, "start");
    x += 60 + 7.4 * static_cast<double>(picture.laws[i].name.size());
  }
  svg.line(60, 42, 90, 42, "#404040", 2, "6 4");
  svg.text(96, 46, "ν = 0.3, complete energy; the others: ν = 0.5", "start");
  svg.line(420, 42, 450, 42, "#b0b0b0", 4);
  svg.text(456, 46, "neo_hookean, ν = 0.5", "start");
  return svg.close();
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {}, {}, true);
  const std::string folder = argc > 1 ? argv[1] : "docs/figures/materials";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const Picture& p : pictures()) {
    if (draw_picture(p, folder)) continue;
    std::fprintf(stderr, "cannot write %s/%s.svg\n", folder.c_str(), p.file.c_str());
    return 1;
  }
  std::printf("%zu pictures in %s\n", pictures().size(), folder.c_str());
  return 0;
}
