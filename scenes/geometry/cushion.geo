// Cushion: a flat square pillow with rounded edges around one closed chamber.
//
// Unit: meter. The footprint lies in the x-z plane around the origin, y is up,
// the underside y = 0 is held. A skin halfway through the wall is meshed too: at
// least two elements across the wall at every mesh size.
//
// Regions: body. Surfaces: chamber (closed), clamped (underside), outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0094, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

side = 0.080;      // footprint
height = 0.030;
wall = 0.010;
corner = 0.020;    // radius of the vertical edges, outside
rim = 0.007;       // radius of the upper edges, outside
e = 1e-5;

// Rounded boxes: outside (0), halfway through the wall (1), chamber (2).
For i In {0:2}
  d = i * wall / 2;
  s = side / 2 - d;
  v = newv;
  Box(v) = {-s, d, -s,  2 * s, height - 2 * d, 2 * s};
  edges() = {};
  For k In {0:3}
    x = (k % 2 == 0) ? -s : s;
    z = (k < 2) ? -s : s;
    edges() += Curve In BoundingBox {x - e, d - e, z - e,  x + e, height - d + e, z + e};
  EndFor
  v1() = Fillet{v}{edges()}{corner - 0.6 * d};
  edges() = Curve In BoundingBox {-s - e, height - d - e, -s - e,  s + e, height - d + e, s + e};
  block~{i}() = Fillet{v1(0)}{edges()}{rim - 0.3 * d};
EndFor
shell() = BooleanDifference{ Volume{block_0(0)}; Delete; }{ Volume{block_1(0)}; };
core() = BooleanDifference{ Volume{block_1(0)}; Delete; }{ Volume{block_2(0)}; };
parts() = BooleanFragments{ Volume{shell(0)}; Delete; }{ Volume{core(0), block_2(0)}; Delete; };
Include "chamber.geo";

s = side / 2 + e;
clamped() = Surface In BoundingBox {-s, -e, -s,  s, e, s};
outer() -= clamped();

Physical Volume("body", 1) = {body()};
Physical Surface("chamber", 2) = {chamber()};
Physical Surface("clamped", 3) = {clamped()};
Physical Surface("outer", 4) = {outer()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{body()};
