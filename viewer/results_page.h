// The results page: one self-contained HTML file that shows a run in any browser, without a network.
//
// A run describes its scene once, appends frames as it goes (each is quantized and compressed on the spot, so
// a long run costs little memory) and writes the file at its end, or several times on the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor {

// A quantity the reader can color the body by.
struct PageField {
  std::string name;           // identifier, used in the address of the page: "pressure"
  std::string label;          // shown: "Pressure"; empty: the name
  std::string unit = {};      // of the values given: "Pa"; empty: none
  bool per_triangle = false;  // one value a triangle instead of one a vertex
  bool diverging = false;     // signed: blue below the center, red above
  double center = 0;          // neutral value of a diverging field (1 for J)
  // Names of the values 0, 1, 2...: a region map with solid colors. Empty: an ordinary number.
  std::vector<std::string> categories = {};
};

// A separate body or obstacle. A part whose triangles close it is filled where the cut plane meets it.
struct PagePart {
  std::string name;
  std::string color = {};  // "#rrggbb"; empty: from the palette, or gray for an obstacle
  // A table, a rigid tool: always in its own color. Its field values and displacements are ignored.
  bool obstacle = false;
};

// A cable: a polyline whose points are given in each frame.
struct PageLine {
  std::string name;
  std::string color = {};
};

// What does not change during the run. Vertices may include nodes inside the body (needed by cells only).
struct PageScene {
  std::vector<Vec3> rest;            // [m]
  std::vector<Index> triangles;      // 3 vertices each, counterclockwise seen from outside
  std::vector<Index> triangle_part;  // one a triangle; empty: all in part 0
  std::vector<std::uint8_t>
      triangle_edges;           // bit k: the edge from corner k is an edge of the mesh; empty: all
  std::vector<Index> cells;     // optional, 4 vertices each: sections then show the field inside
  std::vector<PagePart> parts;  // empty: one without a name
  std::vector<PageField> fields;
  std::vector<PageLine> lines;
  std::vector<std::string> probes;  // names of marked points
  char up = 'z';                    // 'y' or 'z'
};

// What a contact does to a body at one point.
struct PageForce {
  Vec3 at{}, normal{}, friction{};  // [m], [N], [N]
};

// One state of the run. Values that are not finite are shown gray and counted; positions that are not finite
// are drawn at rest and named in a note at the top of the page.
struct PageFrame {
  double time = 0;                          // or load, by PageReport::x_label
  std::string label;                        // "pressurized", "step 12"; may be empty
  std::vector<Vec3> positions;              // one a vertex [m]
  std::vector<std::vector<double>> fields;  // one list a field, in the order of the scene
  std::vector<std::vector<Vec3>> lines;     // points of each line [m]
  std::vector<Vec3> probes;                 // one a probe [m]
  std::vector<Vec3> contacts;               // contact points, any number [m]
  std::vector<PageForce> forces = {};       // of contacts, any number
  std::vector<Vec3> fibers = {};            // both ends of short lines along fibers [m]
};

// A curve. Curves of one group share a chart (of two units at most; more units make more charts).
struct PageSeries {
  std::string group;
  std::string name;
  std::string unit;
  std::vector<double> x = {};
  std::vector<double> y = {};
  bool log = false;  // a chart is logarithmic when all its curves ask for it
};

struct PageEntry {
  std::string key;
  std::string value;  // "#0" and "#1" in it stand for the first two of `numbers`
  // Shown with the prefix of the unit that the charts of this unit have, so that both read alike.
  std::vector<double> numbers = {};
  std::string unit = {};  // of the numbers as given: "Pa"
};

// The planes across x, y and z at which a body is best cut open, and the best of the three.
struct PageSection {
  int axis = 0;  // 0 x, 1 y, 2 z
  Vec3 at{};     // the plane across x at at.x, and so on [m]
};

// The words and curves around the picture.
struct PageReport {
  std::string title;
  std::string subtitle;
  std::string footer;              // version and what was run
  std::vector<PageEntry> run;      // scene, material, step...
  std::vector<PageEntry> summary;  // the answers
  std::vector<std::string> notes;  // what the reader must know; shown above everything
  std::string x_label = "Time";
  std::string x_symbol = "t";
  std::string x_unit = "s";
  std::vector<PageSeries> series;
  std::optional<PageSection> section;  // where cuts open; none: in the middle of everything shown
};

// A whole run at once, for hosts that hold all frames anyway.
struct ResultsPage {
  PageReport report;
  PageScene scene;
  std::vector<PageFrame> frames;
};

// Collects a run frame by frame. Movable; not for use by two threads at once.
class ResultsRecorder {
 public:
  // Refuses scenes whose indices or sizes do not fit together.
  static Result<ResultsRecorder> start(PageScene scene);

  ResultsRecorder(ResultsRecorder&&) noexcept;
  ResultsRecorder& operator=(ResultsRecorder&&) noexcept;
  ~ResultsRecorder();

  // Refuses a frame whose sizes differ from those of the scene; the recorder is unchanged then.
  Result<void> append(const PageFrame& frame);

  std::size_t frame_count() const;
  std::size_t stored_bytes() const;  // compressed, as they will stand in the file

  // Writes next to the target and renames: a reader never sees half a page. May be called at any time.
  Result<void> write(const std::string& path, const PageReport& report) const;

 private:
  struct Content;
  explicit ResultsRecorder(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

Result<void> write_results_page(const std::string& path, const ResultsPage& page);

// False when this library was built without node and npm; writing is then refused with the reason.
bool results_page_available();

}  // namespace isochor
