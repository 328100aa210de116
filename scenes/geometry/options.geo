// Mesh options shared by every geometry of this folder.
//
// One thread, fixed algorithms and Gmsh's fixed seed: the same Gmsh writes the
// same file again. Only physical groups are saved. ASCII is the smaller of the
// two forms here (node and element tags are short numbers) and can be read.
General.NumThreads = 1;
Mesh.Algorithm = 6;            // frontal Delaunay on surfaces
Mesh.Algorithm3D = 1;          // Delaunay in volumes: repeats exactly, HXT does not
Mesh.RandomSeed = 1;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.6;  // mend elements up to this quality, not only slivers
Mesh.SecondOrderLinear = 0;    // nodes of curved Tet10 lie on the true surface
Mesh.HighOrderOptimize = 0;
Mesh.SaveAll = 0;
Mesh.Binary = 0;
Mesh.MshFileVersion = 4.1;
Mesh.MeshSizeFromPoints = 1;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 1;
