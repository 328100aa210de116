// Finger: a bending actuator, a row of round bellows on a flat sole.
//
// Unit: meter. The finger lies along x, its chambers above the plane y = 0, its
// sole below; gravity would be -y. Half-round bellows swell and lengthen, the
// stiff limiting layer under the sole cannot: the finger curls downward, about
// the z axis. All chambers are joined by one channel: a single cavity.
//
// Regions: body, limiting_layer. Surfaces: chamber (closed), clamped (end x = 0,
// both regions), tip (the other end), outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0048, Name "Parameters/target edge length [m]"} ];
DefineConstant[ chambers = {7, Name "Parameters/number of chambers"} ];
Include "options.geo";

pitch = 0.014;
cap = 0.006;             // solid ends
crest = 0.0110;          // outer radius: widest and narrowest
neck = 0.0075;
crest_inner = 0.0080;    // the same of the chamber
neck_inner = 0.0042;
sole = 0.003;
layer = 0.002;           // limiting layer
length = chambers * pitch + 2 * cap;
e = 1e-5;

// Profiles in the plane y = 0, four points a bellow: left and right outline of the
// body, and the right one of the chamber.
n = 4 * chambers;
right() = {};
left() = {};
inside() = {};
For k In {0:n}
  x = cap + k * pitch / 4;
  c = 0.5 - 0.5 * Cos(k * Pi / 2);
  r = neck + c * (crest - neck);
  p = newp; Point(p) = {x, 0, r}; right() += p;
  p = newp; Point(p) = {x, 0, -r}; left() += p;
  p = newp; Point(p) = {x, 0, neck_inner + c * (crest_inner - neck_inner)}; inside() += p;
EndFor
p = newp;
Point(p) = {0, 0, neck};
Point(p + 1) = {0, 0, 0};
Point(p + 2) = {0, 0, -neck};
Point(p + 3) = {length, 0, neck};
Point(p + 4) = {length, 0, 0};
Point(p + 5) = {length, 0, -neck};
Point(p + 6) = {cap, 0, 0};
Point(p + 7) = {length - cap, 0, 0};

l = newl;
Line(l) = {p, right(0)};
Spline(l + 1) = right();
Line(l + 2) = {right(n), p + 3};
Line(l + 3) = {p + 3, p + 4};
Line(l + 4) = {p + 4, p + 1};       // the axis
Line(l + 5) = {p + 1, p};
Line(l + 6) = {p + 2, left(0)};
Spline(l + 7) = left();
Line(l + 8) = {left(n), p + 5};
Line(l + 9) = {p + 4, p + 5};
Line(l + 10) = {p + 2, p + 1};
Line(l + 11) = {p + 6, inside(0)};
Spline(l + 12) = inside();
Line(l + 13) = {inside(n), p + 7};
Line(l + 14) = {p + 7, p + 6};
ll = newll;
Curve Loop(ll) = {l, l + 1, l + 2, l + 3, l + 4, l + 5};
Curve Loop(ll + 1) = {l + 11, l + 12, l + 13, l + 14};
Curve Loop(ll + 2) = {l, l + 1, l + 2, l + 3, l + 9, -(l + 8), -(l + 7), -(l + 6), l + 10, l + 5};
half = news; Plane Surface(half) = {ll};
half_inner = news; Plane Surface(half_inner) = {ll + 1};
outline = news; Plane Surface(outline) = {ll + 2};

// Upper half: turned about the x axis. Sole and limiting layer: the outline pulled
// down.
bellows() = Extrude{ {1, 0, 0}, {0, 0, 0}, -Pi }{ Surface{half}; };
hollow() = Extrude{ {1, 0, 0}, {0, 0, 0}, -Pi }{ Surface{half_inner}; };
floor() = Extrude{0, -sole, 0}{ Surface{outline}; };
under() = Extrude{0, -layer, 0}{ Surface{floor(0)}; };
upper() = BooleanDifference{ Volume{bellows(1)}; Delete; }{ Volume{hollow(1)}; };
parts() = BooleanFragments{ Volume{upper(0)}; Delete; }{ Volume{floor(1), under(1), hollow(1)}; Delete; };
Include "chamber.geo";

W = crest + e;
limiting() = {parts(2)};
flesh() = body();
flesh() -= limiting();
clamped() = Surface In BoundingBox {-e, -W, -W,  e, W, W};
tip() = Surface In BoundingBox {length - e, -W, -W,  length + e, W, W};
outer() -= clamped();
outer() -= tip();

Physical Volume("body", 1) = {flesh()};
Physical Volume("limiting_layer", 2) = {limiting()};
Physical Surface("chamber", 3) = {chamber()};
Physical Surface("clamped", 4) = {clamped()};
Physical Surface("tip", 5) = {tip()};
Physical Surface("outer", 6) = {outer()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{body()};
