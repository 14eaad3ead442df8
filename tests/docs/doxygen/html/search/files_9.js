var searchData=
[
  ['joint_5fpath_2ehpp_0',['joint_path.hpp',['../joint__path_8hpp.html',1,'']]]
];
