// Inflated tube: a straight thick-walled air chamber, held at both ends.
//
// Unit: meter. Axis y, from y = 0 to y = length. The chamber is open at the two
// end planes; both rims are held, so a flat cap closes it without ambiguity.
// A cylinder halfway through the wall is meshed too: it guarantees at least two
// elements across the wall at every mesh size.
//
// Regions: body. Surfaces: chamber (inner wall), ends (both annuli), outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.00567, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

inner_radius = 0.010;
outer_radius = 0.018;
length = 0.080;

Cylinder(1) = {0, 0, 0,  0, length, 0,  outer_radius};
Cylinder(2) = {0, 0, 0,  0, length, 0,  (inner_radius + outer_radius) / 2};
Cylinder(3) = {0, 0, 0,  0, length, 0,  inner_radius};
BooleanDifference(11) = { Volume{1}; Delete; }{ Volume{2}; };
BooleanDifference(12) = { Volume{2}; Delete; }{ Volume{3}; };
parts() = BooleanFragments{ Volume{11}; Delete; }{ Volume{12, 3}; Delete; };
Include "chamber.geo";

e = 1e-5;
R = outer_radius + e;
ends() = Surface In BoundingBox {-R, -e, -R,  R, e, R};
ends() += Surface In BoundingBox {-R, length - e, -R,  R, length + e, R};
outer() -= ends();

Physical Volume("body", 1) = {body()};
Physical Surface("chamber", 2) = {chamber()};
Physical Surface("ends", 3) = {ends()};
Physical Surface("outer", 4) = {outer()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{body()};
