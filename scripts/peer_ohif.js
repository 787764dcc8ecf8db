/** Settings of OHIF: the DICOM server that stands beside its own files. All else as it comes. */
window.config = {
  extensions: [],
  modes: [],
  showStudyList: true,
  defaultDataSourceName: "archive",
  dataSources: [
    {
      namespace: "@ohif/extension-default.dataSourcesModule.dicomweb",
      sourceName: "archive",
      configuration: {
        friendlyName: "archive",
        name: "archive",
        qidoRoot: "/dicom-web",
        wadoRoot: "/dicom-web",
        wadoUriRoot: "/dicom-web",
        imageRendering: "wadors",
        thumbnailRendering: "wadors",
        enableStudyLazyLoad: true,
        supportsWildcard: true,
        singlepart: "bulkdata,video",
        omitQuotationForMultipartRequest: true,
      },
    },
  ],
};
