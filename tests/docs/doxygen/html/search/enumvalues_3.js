var searchData=
[
  ['empty_5fframe_0',['empty_frame',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a03655012b21ab0a22f998ca3dd66fd85',1,'agrisee::study']]]
];
