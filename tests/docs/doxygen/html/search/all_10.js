var searchData=
[
  ['quaternion_0',['quaternion',['../pose_8hpp.html#a0f8896985aa1c6a600f80e54172a460d',1,'agrisee']]]
];
