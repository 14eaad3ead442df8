var searchData=
[
  ['whenever_0',['whenever',['../files_8hpp.html#a8d23f3926520b3e981da84241a802c10ad33dbb9efc361be29ecf9f71d5abe494',1,'agrisee::io']]],
  ['wrong_5fintrinsics_1',['wrong_intrinsics',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a125f78fe1f8d29e8edc36d2fa44059a5',1,'agrisee::study']]],
  ['wrong_5fpose_2',['wrong_pose',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a72311bdd1071a4dfe7c817664262298d',1,'agrisee::study']]]
];
