// Spine: a hanging arm, vertebra-like discs along a slender core.
//
// Unit: meter. The arm lies along x from its held end x = 0; gravity is -y. Disc
// flanks are conical, so that a disc is thick where it meets the core and thin at
// its rim; discs and core taper toward the tip.
//
// Regions: body. Surfaces: clamped (x = 0), tip (the other end), outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.018, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

discs = 7;
pitch = 0.040;
core = 0.030;       // radius of the core at the held end
rim = 0.050;        // radius of the first disc
taper = 0.20;       // both shrink by this share toward the tip
root_half = 0.011;  // half of a disc's thickness at the core
rim_half = 0.006;   // and at its rim
length = discs * pitch;

p0 = newp;
Point(p0) = {0, 0, 0};
Point(p0 + 1) = {0, core, 0};
n = 2;
For k In {0:discs - 1}
  x = (k + 0.5) * pitch;
  s = 1 - taper * x / length;
  Point(p0 + n) = {x - root_half, core * s, 0};
  Point(p0 + n + 1) = {x - rim_half, rim * s, 0};
  Point(p0 + n + 2) = {x + rim_half, rim * s, 0};
  Point(p0 + n + 3) = {x + root_half, core * s, 0};
  n += 4;
EndFor
Point(p0 + n) = {length, core * (1 - taper), 0};
Point(p0 + n + 1) = {length, 0, 0};
n += 2;
l0 = newl;
For k In {0:n - 1}
  Line(l0 + k) = {p0 + k, p0 + (k + 1) % n};
EndFor
Curve Loop(1) = {l0 : l0 + n - 1};
Plane Surface(1) = {1};
arm() = Extrude{ {1, 0, 0}, {0, 0, 0}, 2 * Pi }{ Surface{1}; };

e = 1e-5;
skin() = Abs(Boundary{ Volume{arm(1)}; });
clamped() = Surface In BoundingBox {-e, -1, -1,  e, 1, 1};
tip() = Surface In BoundingBox {length - e, -1, -1,  length + e, 1, 1};
clamped() -= {1};
outer() = skin();
outer() -= clamped();
outer() -= tip();

Physical Volume("body", 1) = {arm(1)};
Physical Surface("clamped", 2) = {clamped()};
Physical Surface("tip", 3) = {tip()};
Physical Surface("outer", 4) = {outer()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{arm(1)};
