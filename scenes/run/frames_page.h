// The results page of a folder of frames: what `run` wrote, or any ParaView collection (.pvd) of .vtu files
// whose points carry a displacement.
#pragma once

#include <string>

#include "isochor/types.h"

namespace isochor {

struct FramesPage {
  std::string path;  // of the page
  std::size_t frames = 0, elements = 0;
};

// Reads the folder's collection and, where there is one, its steps.csv, and writes index.html beside them.
// Colors: fields of one component at points. What only the run itself knows (cables, obstacles, contacts,
// sections through several bodies) is not in the frames and not on the page.
Result<FramesPage> write_frames_page(const std::string& folder);

}  // namespace isochor
