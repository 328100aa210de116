// Descriptions of the parts of a scene that are no effects.
#pragma once

#include "scenes/keys/keys.h"

namespace isochor::keys {

void describe(Visitor& io, MaterialDef& m);
void describe_fiber_law(Visitor& io, FiberFamily& f);  // its constants, without directions
void describe(Visitor& io, CellField& f);
void describe(Visitor& io, BoxMeshDef& b);
void describe(Visitor& io, LatticeMesh& l);
void describe_at_rest(Visitor& io, SceneBody& b);  // all but how it moves at the start
void describe(Visitor& io, SceneBody& b);
// What of an analysis concerns a world: its scheme, and how its steps are solved.
void describe_scheme(Visitor& io, AnalysisDef& a, AnalysisType standard);
void describe_solving(Visitor& io, WorldOptions& options);
void describe(Visitor& io, AnalysisDef& a);
void describe(Visitor& io, ProbeDef& p);
void describe(Visitor& io, OrientationDef& o);
void describe(Visitor& io, OutputDef& o);
void describe(Visitor& io, MetricDef& m);
// All of it: bodies and the analysis come first, since names of bodies and the meaning of plain numbers
// depend on them.
void describe(Visitor& io, SceneDef& s);

}  // namespace isochor::keys
