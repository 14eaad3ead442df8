var searchData=
[
  ['frozen_5fframe_0',['frozen_frame',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33acd127ed624da4a4b36e0f80c498e1350',1,'agrisee::study']]]
];
